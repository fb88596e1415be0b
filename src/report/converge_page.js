'use strict';
(() => {
  const {$, data, unique, words, element, plain, fill} = kit;

  // ---- the studies, unpacked

  const studies =
      data.studies.map(([
                         surface, mesh,  method, of_class, quantity, order, low, high, expected, max_order,
                         verdict, holds, floor,  at,       rms,      p95,   max, used, least,    most
                       ]) => {
        const grid = data.grids[surface][mesh], seconds = data.seconds[surface][mesh][method];
        const places = at || rms.map((_, i) => i);
        return {
          surface: data.surfaces[surface],
          mesh: data.meshes[mesh].name,
          method: data.methods[method].name,
          class: data.classes[of_class],
          quantity: data.quantities[quantity],
          order,
          low,
          high,
          expected,
          max_order,
          verdict: data.verdicts[verdict],
          holds: holds === 1,
          floor,
          exact: order === null,
          levels: places.map((k, i) => ({
                               n: grid[k][0],
                               h: grid[k][1],
                               seconds: seconds[k],
                               rms: rms[i],
                               p95: p95[i],
                               max: max[i],
                               used: used[i] === 1,
                               least: least ? least[i] : rms[i],
                               most: most ? most[i] : rms[i]
                             }))
        };
      });
  const looks = new Map(data.methods.map((m, i) => [m.name, kit.look(i)]));
  // Random meshes first: on regular ones much is exact by symmetry.
  const mesh_order = [...data.meshes].sort((a, b) => b.random - a.random).map(m => m.name);
  const of_mesh = Object.fromEntries(data.meshes.map(m => [m.name, m]));
  const classes = [...data.classes].sort((a, b) => (b === 'interior') - (a === 'interior'));
  const in_order = (names, order) => order.filter(name => names.includes(name));
  const is = (...keys) => s => keys.every(k => s[k] === $(k).value);
  const fixed = x => (Math.round(100 * x) / 100 + 0).toFixed(2);
  const time = s => s >= 1 ? plain(s, 2) + ' s' :
      s >= 1e-3            ? plain(s * 1e3, 2) + ' ms' :
                             plain(s * 1e6, 2) + ' µs';
  const interval = s => s.exact ? '–' : fixed(s.low) + ' to ' + fixed(s.high);
  const never = s => s.verdict === 'does not converge';
  const verdict = s => {
    const symbol = s.exact     ? '–' :
        never(s)               ? '×' :
        s.verdict === 'slower' ? '▼' :
        s.verdict === 'faster' ? '▲' :
                                 '✓';
    const rare = !s.exact && !never(s) && s.max_order < data.least_order ?
        '; the largest error does not converge' :
        '';
    return `${symbol} ${s.verdict}${s.holds && never(s) ? ', as expected' : ''}${rare}`;
  };

  // ---- the slopes 1, 2 and 3, beside the data
  const beside = () => innerWidth < 640 ? 88 : 130;
  const guides = {
    id: 'guides',
    afterDraw: chart => {
      const {ctx, chartArea: area, scales: {x, y}} = chart;
      const per_x = (area.right - area.left) / (x.max - x.min),
            per_y = (area.bottom - area.top) / (y.max - y.min);
      const steepest = 3 * per_y / per_x,
            run = Math.min(beside() - 62, 0.9 * (area.bottom - area.top) / steepest);
      const x1 = area.right + 8, y1 = area.top + 12 + run * steepest;
      const rise = run * per_y / per_x, apart = Math.max(rise, 14);
      chart.$guides = [1, 2, 3].map(order => ({
                                      x1,
                                      y1,
                                      x2: x1 + run,
                                      y2: y1 - order * rise,
                                      x: x1 + run + 4,
                                      y: y1 - 2 * rise - (order - 2) * apart + 4,
                                      text: 'order ' + order
                                    }));
      ctx.save();
      ctx.strokeStyle = ctx.fillStyle = kit.css('soft');
      ctx.font = '12px system-ui, sans-serif';
      ctx.setLineDash([5, 4]);
      for (const g of chart.$guides) {
        ctx.beginPath();
        ctx.moveTo(g.x1, g.y1);
        ctx.lineTo(g.x2, g.y2);
        ctx.stroke();
        ctx.fillText(g.text, g.x, g.y);
      }
      ctx.restore();
    }
  };

  const tooltip = {
    title: items => items.length ? items[0].raw.level.n + ' rows, h = ' + plain(items[0].raw.level.h) : '',
    label: item => {
      const l = item.raw.level;
      return [
        `${item.dataset.label}: rms ${plain(l.rms)}°` +
            (l.least < l.most ? ` (${plain(l.least)} to ${plain(l.most)} by seed)` : '') +
            `, 95 % below ${plain(l.p95)}°, largest ${plain(l.max)}°`,
        'in ' + time(l.seconds) + (l.used ? '' : ', not in the fit')
      ];
    }
  };
  let widths = [];
  const against_h = kit.picture('against-h', {
    x: {title: 'mesh width h, finer to the left', ticks: () => widths},
    y: {title: 'error in degrees'},
    tooltip,
    plugins: [guides],
    right: beside()
  });
  const against_time = kit.picture('against-time', {
    x: {title: 'run time on the whole mesh, one thread', text: v => time(10 ** v)},
    y: {title: 'error in degrees'},
    tooltip
  });
  const title = () => [words($('quantity').value), words($('class').value), $('surface').value.split(':')[0],
                       $('mesh').value, 'meshes']
                          .join(' ');
  kit.offer_picture(against_h, () => 'error against h ' + title());
  kit.offer_picture(against_time, () => 'error against time ' + title());

  let chosen_method = null;
  function draw() {
    const statistic = $('statistic').value;
    const chosen = studies.filter(is('surface', 'mesh', 'class', 'quantity'));
    const floor = chosen.filter(s => s.exact);
    const drawn = chosen.filter(s => !s.exact && !kit.hidden.has(s.method));
    for (const [chart, key] of [[against_h, 'h'], [against_time, 'seconds']]) {
      chart.data.datasets = drawn.map(
          s => kit.line(
              s.method, looks.get(s.method),
              s.levels.filter(l => l[statistic] > 0)
                  .map(level => ({x: Math.log10(level[key]), y: Math.log10(level[statistic]), level})),
              {open: p => !p.level.used, borderWidth: s.method === chosen_method ? 4.5 : 2}));
      const points = chart.data.datasets.flatMap(d => d.data);
      if (!points.length) continue;
      kit.limits(chart.options.scales.x, points.map(p => p.x), 0.08);
      kit.limits(chart.options.scales.y, points.map(p => p.y), 0.2);
      if (chart === against_h) widths = unique(points.map(p => p.x)).sort((a, b) => a - b);
    }
    against_h.update();
    against_time.update();
    const what = title();
    $('against-h')
        .setAttribute('aria-label', 'Error against mesh width: ' + what + '. The numbers are in the table.');
    $('against-time').setAttribute('aria-label', 'Error against run time: ' + what + '.');
    $('what').textContent = 'Error of the ' + words($('quantity').value) + ': ' +
        $('surface').value.split(':')[0] + ', ' + $('mesh').value + ' meshes, ' + words($('class').value) +
        ' vertices';
    $('about-mesh').textContent = 'Mesh: ' + of_mesh[$('mesh').value].summary + '.';
    $('at-floor').textContent = floor.length ?
        'Not drawn, because their error is nothing but rounding (about ' +
            plain(Math.max(...floor.map(s => s.floor)), 2) +
            '° or less): ' + floor.map(s => s.method).join(', ') + '.' :
        '';
    for (const label of $('legend').children)
      label.classList.toggle('absent', !chosen.some(s => s.method === label.dataset.name && !s.exact));
    document.body.dataset.lines = drawn.length;
    map();
    filter();
  }

  // ---- from a verdict, or a cell of the map, to its curve
  function follow(s) {
    $('surface').value = s.surface;
    kit.hidden.delete(s.method);
    chosen_method = s.method;
    choices(s);
    $('interactive').scrollIntoView({block: 'start'});
    $('against-h').focus({preventScroll: true});
  }
  const link = (s, text, className) => {
    const button = element('button', {type: 'button', className, textContent: text});
    button.addEventListener('click', () => follow(s));
    return button;
  };

  // ---- the map: method by mesh and class
  const step = s => !s.holds ? 's4' :
      s.exact                ? 'good' :
      never(s)               ? 'plain' :
      s.order < 0.75         ? 's0' :
      s.order < 1.25         ? 's1' :
      s.order < 1.75         ? 's2' :
      s.order < 2.5          ? 's3' :
                               's5';
  function map() {
    const chosen = studies.filter(is('surface', 'quantity'));
    const meshes = in_order(chosen.map(s => s.mesh), mesh_order);
    const shown = meshes.map(m => in_order(chosen.filter(s => s.mesh === m).map(s => s.class), classes));
    const names = element('tr', {}, element('th')),
          heads = element('tr', {}, element('th', {textContent: 'method'}));
    meshes.forEach(
        (m, i) => names.append(element('th', {colSpan: shown[i].length, textContent: m, scope: 'col'})));
    shown.flat().forEach(
        c => heads.append(element('th', {scope: 'col', className: 'n', textContent: words(c)})));
    const rows = data.methods.map(
        m => element(
            'tr', {}, element('th', {scope: 'row', textContent: m.name}),
            ...meshes.flatMap((mesh, i) => shown[i].map(c => {
              const s = chosen.find(t => t.method === m.name && t.mesh === mesh && t.class === c);
              if (!s) return element('td');
              const cell = element(
                  'td', {className: step(s)},
                  link(
                      s,
                      s.exact      ? 'exact' :
                          never(s) ? '×' :
                                     s.order.toFixed(1)));
              cell.firstChild.title = `${s.method}, ${mesh}, ${words(c)}: ` +
                  (s.exact ? 'at the floor of rounding' : `${fixed(s.order)}, ${interval(s)}; ${verdict(s)}`);
              cell.classList.toggle('chosen', s.method === chosen_method && is('mesh', 'class')(s));
              return cell;
            }))));
    $('map').replaceChildren(element('thead', {}, names, heads), element('tbody', {}, ...rows));
    $('map-of').textContent =
        'Orders of the ' + words($('quantity').value) + ': ' + $('surface').value.split(':')[0];
  }
  kit.offer_table(
      $('map'), () => 'orders ' + words($('quantity').value) + ' ' + $('surface').value.split(':')[0]);

  // ---- all studies
  const cell = (text, number) => element('td', {textContent: text, className: number ? 'n' : ''});
  const row = s => {
    const last = s.levels[s.levels.length - 1];
    const badge = element(
        'td', {},
        link(
            s, verdict(s),
            'link verdict ' +
                (!s.holds                ? 'bad' :
                     s.exact || never(s) ? 'plain' :
                                           'good')));
    return element(
        'tr', {className: 'study'}, element('th', {scope: 'row', textContent: s.method}),
        cell(s.surface.split(':')[0]), cell(s.mesh), cell(words(s.class)), cell(words(s.quantity)),
        cell(plain(last.rms, 2), true), cell(s.exact ? '–' : fixed(s.order), true), cell(interval(s), true),
        cell(plain(s.expected, 2), true), cell(plain(s.floor, 1), true), badge);
  };
  const rows = studies.map(
      s => ({
        study: s,
        make: () => row(s),
        text: [s.method, s.surface, s.mesh, words(s.class), s.quantity, verdict(s)].join(' ').toLowerCase()
      }));
  const table = kit.table(
      $('studies'),
      [
        {name: 'method', value: r => r.study.method}, {name: 'surface', value: r => r.study.surface},
        {name: 'mesh', value: r => r.study.mesh}, {name: 'vertices', value: r => r.study.class},
        {name: 'quantity', value: r => r.study.quantity},
        {name: 'error', number: true, value: r => r.study.levels[r.study.levels.length - 1].rms},
        {name: 'order', number: true, value: r => r.study.order},
        {name: '95 % interval', number: true, value: r => r.study.low},
        {name: 'expected', number: true, value: r => r.study.expected},
        {name: 'floor', number: true, value: r => r.study.floor},
        {name: 'verdict', value: r => verdict(r.study)}
      ],
      {find: $('find')});
  kit.offer_table($('studies'), () => 'studies');
  function filter() {
    table.set(
        $('only').checked ? rows.filter(r => is('surface', 'mesh', 'class', 'quantity')(r.study)) : rows);
  }

  // A choice leaves those below it with what still exists. \param wanted choices that win
  function choices(wanted) {
    const set = (id, values, order) => {
      fill($(id), in_order(unique(values), order), words);
      if (wanted) $(id).value = wanted[id];
    };
    set('mesh', studies.filter(is('surface')).map(s => s.mesh), mesh_order);
    set('class', studies.filter(is('surface', 'mesh')).map(s => s.class), classes);
    set('quantity', studies.filter(is('surface', 'mesh', 'class')).map(s => s.quantity), data.quantities);
    kit.legend(
        'legend', data.methods.map(m => ({name: m.name, title: m.summary, look: looks.get(m.name)})), draw);
    draw();
  }
  fill($('surface'), data.surfaces);
  for (const id of ['surface', 'mesh', 'class', 'quantity', 'statistic'])
    $(id).addEventListener('change', () => {
      chosen_method = null;
      choices();
    });
  $('only').addEventListener('change', filter);
  if (studies.length) choices();
  kit.ready(draw);
})();
