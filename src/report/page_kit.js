'use strict';
addEventListener('error', e => {
  document.body.dataset.error = e.message;
});

// What the pages of all report commands share. Pictures have logarithms on both axes: their points are
// {x: log10, y: log10, ...}, and Chart.js draws them on linear scales, which also take 600 decades.
const kit = (() => {
  const $ = id => document.getElementById(id);
  const data = JSON.parse($('data').textContent);
  const unique = list => [...new Set(list)];
  const words = name => name.replaceAll('_', ' ');
  const element = (kind, properties = {}, ...children) => {
    const made = Object.assign(document.createElement(kind), properties);
    made.append(...children);
    return made;
  };

  // ---- numbers for people
  const superscript = e => String(e).replace(/./g, c => c === '-' ? '⁻' : '⁰¹²³⁴⁵⁶⁷⁸⁹'[c]);
  const plain = (x, digits = 3) => {
    if (x === null || x === undefined) return '';
    if (x === 0 || (Math.abs(x) >= 1e-3 && Math.abs(x) < 1e4)) return String(+x.toPrecision(digits));
    const e = Math.floor(Math.log10(Math.abs(x)) + 1e-9), m = +(x / 10 ** e).toPrecision(digits);
    return (m === 1 ? '' : m + '·') + '10' + superscript(e);
  };

  // ---- looks: Okabe and Ito's colours, which colour-blind readers tell apart, and seven shapes; of 49 no
  // two have both in common, and of seven that follow each other none has either
  const colours = ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#b08900', '#56b4e9', '#7f7f7f'];
  const shapes = ['circle', 'triangle', 'rect', 'rectRot', 'star', 'crossRot', 'cross'];
  const look = i =>
      ({colour: colours[i % 7], shape: shapes[(i + Math.floor(i / 7)) % 7], dash: i < 7 ? [] : [7, 3]});
  const is_open = shape => shape === 'star' || shape === 'crossRot' || shape === 'cross';
  const mark_path = (shape, x, y, r) =>
      ({
        circle: `M${x - r} ${y}a${r} ${r} 0 1 0 ${2 * r} 0a${r} ${r} 0 1 0 ${- 2 * r} 0z`,
        triangle: `M${x} ${y - r}l${r} ${1.8 * r}h${- 2 * r}z`,
        rect: `M${x - r} ${y - r}h${2 * r}v${2 * r}h${- 2 * r}z`,
        rectRot:
            `M${x} ${y - 1.2 * r}l${1.2 * r} ${1.2 * r}l${- 1.2 * r} ${1.2 * r}l${- 1.2 * r} ${- 1.2 * r}z`,
        star: `M${x} ${y - r}v${2 * r}M${x - r} ${y}h${2 * r}M${x - .7 * r} ${y - .7 * r}l${1.4 * r} ${
                  1.4 * r}` +
            `M${x + .7 * r} ${y - .7 * r}l${- 1.4 * r} ${1.4 * r}`,
        crossRot: `M${x - .8 * r} ${y - .8 * r}l${1.6 * r} ${1.6 * r}M${x + .8 * r} ${y - .8 * r}` +
            `l${- 1.6 * r} ${1.6 * r}`,
        cross: `M${x} ${y - r}v${2 * r}M${x - r} ${y}h${2 * r}`
      })[shape] ||
      '';
  const escaped = text => String(text).replace(/[&<>"]/g, c => `&#${c.charCodeAt(0)};`);
  const icon = ({colour, shape, dash, line = true, hollow}) =>
      `<svg width="32" height="14" stroke="${colour}" fill="${hollow ? 'none' : colour}" stroke-width="2"
    aria-hidden="true">${line ? `<path d="M0 7h32" stroke-dasharray="${(dash || []).join(' ')}"/>` : ''}
    <path d="${mark_path(shape, 16, 7, 5)}"/></svg>`;

  // ---- colours of the page, which change with the theme and on paper
  const css = name => getComputedStyle(document.body).getPropertyValue('--' + name).trim();
  const charts = [];
  // What draws again with other colours; ready() is given it.
  let redraw = () => {};
  for (const query of ['(prefers-color-scheme: dark)', 'print'])
    matchMedia(query).addEventListener('change', () => {
      charts.forEach(paint);
      redraw();
    });

  // ---- logarithmic axes: ten ticks or fewer at powers of ten, or at 1, 2, 5 where there are few of them
  const log_ticks = (min, max) => {
    const list = [];
    if (max - min <= 2.2) {
      for (let e = Math.floor(min); e <= max; ++e)
        for (const s of [1, 2, 5]) list.push(e + Math.log10(s));
    } else {
      const step = [1, 2, 5, 10, 20, 50, 100].find(s => (max - min) / s <= 10) || 200;
      for (let e = Math.ceil(min / step) * step; e <= max; e += step) list.push(e);
    }
    return list.filter(v => v >= min - 1e-9 && v <= max + 1e-9);
  };
  const axis = ({title = '', text = v => plain(10 ** v, 2), ticks = log_ticks}) => ({
    type: 'linear',
    title: {display: true, text: title, font: {size: 13}},
    afterBuildTicks: a => {
      a.ticks = ticks(a.min, a.max).map(value => ({value}));
    },
    ticks: {callback: text, font: {size: 12}, maxRotation: 0, autoSkip: true, autoSkipPadding: 6}
  });
  const limits = (scale, values, below, above = below) => {
    scale.min = Math.min(...values) - below;
    scale.max = Math.max(...values) + above;
  };

  function paint(chart) {
    for (const scale of Object.values(chart.options.scales)) {
      scale.title.color = scale.ticks.color = css('soft');
      scale.grid = {color: css('line')};
    }
  }

  // ---- a picture
  function picture(id, {x, y, tooltip, plugins = [], right = 28}) {
    const canvas = $(id);
    const chart = new Chart(canvas, {
      type: 'line',
      data: {datasets: []},
      plugins,
      options: {
        animation: false,
        responsive: true,
        maintainAspectRatio: false,
        parsing: false,
        layout: {padding: {right}},
        interaction: {mode: 'nearest', intersect: false},
        scales: {x: axis(x), y: axis(y)},
        plugins: {legend: {display: false}, tooltip: {callbacks: tooltip}}
      }
    });
    charts.push(chart);
    paint(chart);
    // Arrow keys go from point to point, and from line to line.
    let at = null;
    const show = () => {
      const point = at && chart.getDatasetMeta(at.datasetIndex).data[at.index];
      chart.setActiveElements(at ? [at] : []);
      chart.tooltip.setActiveElements(at ? [at] : [], point ? {x: point.x, y: point.y} : {x: 0, y: 0});
      chart.update();
    };
    canvas.tabIndex = 0;
    canvas.addEventListener('blur', () => {
      at = null;
      show();
    });
    canvas.addEventListener('keydown', e => {
      const sets = chart.data.datasets;
      const step = {ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowUp: [-1, 0], ArrowDown: [1, 0]}[e.key];
      if (!step || !sets.length || e.ctrlKey || e.altKey || e.metaKey) return;
      e.preventDefault();
      const wrap = (i, n) => (i + n) % n;
      const set = at ? wrap(at.datasetIndex + step[0], sets.length) : 0, n = sets[set].data.length;
      if (!n) return;
      // Points are in the order of x, or against it.
      const forth = sets[set].data[0].x <= sets[set].data[n - 1].x ? 1 : -1;
      at = {datasetIndex: set, index: at ? wrap(Math.min(at.index, n - 1) + forth * step[1], n) : 0};
      show();
    });
    return chart;
  }
  // A line of a picture. \param open which points are not filled
  const line = (label, {colour, shape, dash}, points, more = {}) => {
    const {open = () => false, ...rest} = more;
    return {
      label,
      data: points,
      borderColor: colour,
      borderWidth: 2,
      borderDash: dash,
      pointStyle: shape,
      pointRadius: is_open(shape) ? 6 : 5,
      pointHoverRadius: 9,
      pointBorderWidth: is_open(shape) ? 2 : 1.5,
      pointBackgroundColor: points.map(p => open(p) ? css('card') : colour),
      shape,
      ...rest
    };
  };

  // ---- what is drawn, as SVG and as CSV
  function svg_of(chart, title) {
    const {width, chartArea: area, scales: {x, y}} = chart, top = 30, ink = css('ink'), grid = css('line');
    const n = v => +v.toFixed(1), sets = chart.data.datasets, names = sets.map(s => s.label);
    const columns = Math.max(1, Math.floor(width / 190));
    const height = top + chart.height + 22 * Math.ceil(names.length / columns) + 10;
    const text = (px, py, what, anchor = 'start', more = '') => `<text x="${n(px)}" y="${
        n(py)}" text-anchor="${anchor}" fill="${ink}"${more}>${escaped(what)}</text>\n`;
    const stroke = (d, colour, dash, w = 1) => `<path d="${d}" fill="none" stroke="${colour}" stroke-width="${
        w}" stroke-dasharray="${dash || ''}"/>\n`;
    let out = `<svg xmlns="http://www.w3.org/2000/svg" width="${n(width)}" height="${n(height)}" ` +
        `viewBox="0 0 ${n(width)} ${n(height)}" font-family="sans-serif" font-size="12">\n` +
        `<path fill="${css('card')}" d="M0 0h${n(width)}v${n(height)}H0z"/>\n` +
        text(12, 20, title, 'start', ' font-weight="bold"') + `<g transform="translate(0 ${top})">\n`;
    for (const t of x.ticks) {
      const px = n(x.getPixelForValue(t.value));
      out += stroke(`M${px} ${n(area.top)}V${n(area.bottom)}`, grid) +
          text(px, area.bottom + 16, t.label, 'middle');
    }
    for (const t of y.ticks) {
      const py = n(y.getPixelForValue(t.value));
      out += stroke(`M${n(area.left)} ${py}H${n(area.right)}`, grid) +
          text(area.left - 6, py + 4, t.label, 'end');
    }
    out += text((area.left + area.right) / 2, area.bottom + 34, x.options.title.text, 'middle');
    const middle = (area.top + area.bottom) / 2;
    out += text(14, middle, y.options.title.text, 'middle', ` transform="rotate(-90 14 ${n(middle)})"`);
    for (const g of chart.$guides || [])
      out +=
          stroke(`M${n(g.x1)} ${n(g.y1)}L${n(g.x2)} ${n(g.y2)}`, css('soft'), '5 5') + text(g.x, g.y, g.text);
    sets.forEach((set, i) => {
      const points = chart.getDatasetMeta(i).data;
      const fill = set.pointBackgroundColor;
      if (set.showLine !== false && points.length > 1)
        out += stroke(
            points.map((p, k) => (k ? 'L' : 'M') + n(p.x) + ' ' + n(p.y)).join(''), set.borderColor,
            (set.borderDash || []).join(' '), set.borderWidth);
      if (set.pointRadius !== 0)
        points.forEach((p, k) => {
          out += `<path d="${mark_path(set.shape, n(p.x), n(p.y), 5)}" stroke="${set.borderColor}" fill="${
              Array.isArray(fill) ? fill[k] : fill || set.borderColor}" stroke-width="1.5"/>\n`;
        });
    });
    out += '</g>\n';
    sets.forEach((set, i) => {
      const px = 20 + 190 * (i % columns), py = top + chart.height + 14 + 22 * Math.floor(i / columns);
      out += stroke(`M${px} ${py}h32`, set.borderColor, (set.borderDash || []).join(' '), 2) +
          `<path d="${mark_path(set.shape, px + 16, py, 5)}" stroke="${set.borderColor}" ` +
          `fill="${set.borderColor}"/>\n` + text(px + 40, py + 4, set.label);
    });
    return out + '</svg>\n';
  }
  const csv_cell = value => /[",\r\n]/.test(value) ? '"' + String(value).replaceAll('"', '""') + '"' : value;
  const csv_lines = rows => rows.map(row => row.map(csv_cell).join(',') + '\r\n').join('');
  const csv_of = chart => csv_lines([
    ['line', chart.options.scales.x.title.text, chart.options.scales.y.title.text],
    ...chart.data.datasets.flatMap(
        set => set.data.map(
            p =>
                [set.label,
                 ...[[p.value, p.x], [p.error, p.y]].map(
                     ([given, log]) => given === undefined ? +(10 ** log).toPrecision(6) :
                         given === null                    ? '' :
                                                             given)]))
  ]);
  // A table whose cells have colours.
  function svg_of_table(table) {
    const box = table.getBoundingClientRect(), n = v => +v.toFixed(1);
    let out = `<svg xmlns="http://www.w3.org/2000/svg" width="${n(box.width)}" ` +
        `height="${n(box.height)}" font-family="sans-serif" font-size="12">\n<path fill="${
                  css('card')}" d="M0 0h${n(box.width)}v${n(box.height)}H0z"/>\n`;
    for (const cell of table.querySelectorAll('th,td')) {
      const r = cell.getBoundingClientRect(), style = getComputedStyle(cell), px = r.left - box.left;
      if (!r.width) continue;
      if (cell.tagName === 'TD')
        out += `<path fill="${style.backgroundColor}" d="M${n(px)} ${n(r.top - box.top)}h${n(r.width)}v${
            n(r.height)}h${n(-r.width)}z"/>\n`;
      const right = style.textAlign === 'right', middle = style.textAlign === 'center';
      // A head that stands upright, read from below.
      const upright = style.writingMode !== 'horizontal-tb', foot = [r.left + r.width / 2 + 4, r.bottom - 6];
      const [fx, fy] = [n(foot[0] - box.left), n(foot[1] - box.top)];
      if (upright)
        out += `<text transform="translate(${fx} ${fy}) rotate(-90)" fill="${style.color}">${
            escaped(cell.innerText.trim())}</text>\n`;
      else
        out += `<text x="${
                 n(right      ? px + r.width - 8 :
                       middle ? px + r.width / 2 :
                                px + 8)}" y="${n((r.top + r.bottom) / 2 - box.top + 4)}" ` +
          `text-anchor="${
                 right      ? 'end' :
                     middle ? 'middle' :
                              'start'}" fill="${style.color}">${escaped(cell.innerText.trim())}</text>\n`;
    }
    return out + '</svg>\n';
  }
  const csv_of_table = table =>
      csv_lines([...table.rows]
                    .filter(row => !row.hidden)
                    .map(
                        row => [...row.cells].flatMap(
                            cell => [cell.innerText.trim(), ...Array(cell.colSpan - 1).fill('')])));

  function download(name, type, text) {
    const link = element('a', {href: URL.createObjectURL(new Blob([text], {type})), download: name});
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  }
  // Buttons below a picture or a table.
  function offer(host, name, svg, csv) {
    const button = (text, type, make) => {
      const made = element('button', {type: 'button', textContent: text, className: 'tool'});
      made.addEventListener('click', () => download(name() + '.' + text.toLowerCase(), type, make()));
      return made;
    };
    host.append(element(
        'p', {className: 'tools'}, ...(svg ? [button('SVG', 'image/svg+xml', svg)] : []),
        button('CSV', 'text/csv', csv)));
  }
  const file_name = (...parts) => parts.join('-').replace(/[^A-Za-z0-9._-]+/g, '-');
  const offer_picture = (chart, title) => offer(
      chart.canvas.closest('figure'), () => file_name(title()), () => svg_of(chart, title()),
      () => csv_of(chart));
  const offer_table = (table, title) => offer(
      table.closest('.scroll').parentElement, () => file_name(title()), () => svg_of_table(table),
      () => csv_of_table(table));

  // ---- the legend: a check box per line. \param items {name, title, look}
  const hidden = new Set();
  function legend(id, items, changed) {
    $(id).replaceChildren(...items.map(({name, title, look}) => {
      const box = element('input', {type: 'checkbox', checked: !hidden.has(name)});
      box.addEventListener('change', () => {
        if (box.checked)
          hidden.delete(name);
        else
          hidden.add(name);
        changed();
      });
      const label = element('label', {title: title || ''});
      label.dataset.name = name;
      label.innerHTML = icon(look);
      label.prepend(box);
      label.append(words(name));
      return label;
    }));
  }

  // ---- tables that are sorted by a click on a head, and filtered by words
  const most_rows = 400;
  function table(host, columns, {find} = {}) {
    let rows = [], by = -1, down = false;
    const body = host.tBodies[0] || host.createTBody(), head = element('tr');
    const note = element('p', {className: 'soft'});
    const buttons = columns.map((column, i) => {
      const button = element('button', {type: 'button', textContent: column.name, className: 'sort'});
      button.addEventListener('click', () => {
        down = by === i ? !down : false;
        by = i;
        draw();
      });
      const cell = element('th', {scope: 'col', className: column.number ? 'n' : ''}, button);
      head.append(cell);
      return cell;
    });
    if (!host.tHead) host.createTHead();
    host.tHead.replaceChildren(head);
    host.closest('.scroll').after(note);
    const compare = (a, b) => {
      const [x, y] = [a, b].map(columns[by].value);
      const none = v => v === null || v === undefined || Number.isNaN(v);
      if (none(x) || none(y)) return none(x) - none(y);  // what has no value comes last
      return (down ? -1 : 1) * (typeof x === 'number' ? x - y : String(x).localeCompare(String(y)));
    };
    function draw() {
      const wanted = find ? find.value.toLowerCase().split(/\s+/).filter(w => w) : [];
      let list = wanted.length ? rows.filter(r => wanted.every(w => r.text.includes(w))) : rows;
      if (by >= 0) list = [...list].sort(compare);
      body.replaceChildren(...list.slice(0, most_rows).map(r => r.element || (r.element = r.make())));
      buttons.forEach((cell, i) => {
        if (i === by)
          cell.ariaSort = down ? 'descending' : 'ascending';
        else
          cell.removeAttribute('aria-sort');
      });
      note.textContent = list.length > most_rows ? `${most_rows} of ${list.length} rows are shown.` : '';
      host.dataset.rows = list.length;
    }
    if (find) find.addEventListener('input', draw);
    return {
      set(given) {
        rows = given;
        draw();
      }
    };
  }
  // The same of a table that the page already has.
  function adopt(host) {
    const number = text => text === '' ? null : Number.isNaN(+text) ? text : +text;
    const columns =
        [...host.tHead.rows[0].cells].map((cell, i) => ({
                                            name: cell.textContent.trim(),
                                            number: cell.classList.contains('n'),
                                            value: r => number(r.element.cells[i].textContent.trim())
                                          }));
    const rows = [...host.tBodies[0].rows].map(tr => ({element: tr, text: tr.textContent.toLowerCase()}));
    const find = host.closest('section').querySelector('input[type=search]');
    table(host, columns, {find}).set(rows);
    offer_table(host, () => host.dataset.name || document.title);
  }

  // ---- choices
  const fill = (select, values, text = v => v) => {
    const old = select.value;
    select.replaceChildren(...values.map(v => new Option(text(v), v)));
    if (values.includes(old)) select.value = old;
  };
  // Shows the pictures, which have no size before. \param draw what draws the choices as they are
  function ready(draw) {
    redraw = draw;
    $('interactive').hidden = false;
    charts.forEach(chart => chart.resize());
    for (const host of document.querySelectorAll('table.adopt')) adopt(host);
    for (const label of document.querySelectorAll('.needs-script')) label.hidden = false;
    document.body.dataset.charts = charts.filter(chart => chart.width > 0).length;
  }

  return {
    $,
    data,
    unique,
    words,
    element,
    plain,
    superscript,
    look,
    icon,
    css,
    picture,
    line,
    limits,
    hidden,
    legend,
    table,
    offer_picture,
    offer_table,
    fill,
    ready
  };
})();
