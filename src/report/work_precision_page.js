'use strict';
addEventListener('error', e => {
  document.body.dataset.error = e.message;
});

(() => {
  const data = JSON.parse(document.getElementById('data').textContent);
  const $ = id => document.getElementById(id);
  const least = 1e-17;  // what is below it is drawn there
  const is_time = metric => metric === 'time_ns' || metric === 'seconds';
  const plain = x => x === null ? '' :
      x === 0                   ? '0' :
      x >= 0.001 && x < 1e6     ? String(+x.toPrecision(3)) :
                                  x.toExponential(1);
  const dark = matchMedia('(prefers-color-scheme: dark)');
  const ink = () => getComputedStyle(document.body).getPropertyValue('--soft');

  const is_decade = x => Math.abs(Math.log10(x) - Math.round(Math.log10(x))) < 1e-9;
  const axis = () => ({
    type: 'logarithmic',
    title: {display: true, text: ''},
    ticks: {maxRotation: 0, callback: x => is_decade(x) ? plain(x).replace('.0e', 'e') : ''}
  });
  const chart = new Chart($('plot'), {
    type: 'scatter',
    data: {datasets: []},
    options: {
      animation: false,
      responsive: true,
      maintainAspectRatio: false,
      scales: {x: axis(), y: axis()},
      plugins: {
        legend: {labels: {usePointStyle: true}},
        tooltip: {callbacks: {label: item => item.raw.text || ''}}
      }
    }
  });

  function paint() {
    chart.options.plugins.legend.labels.color = ink();
    for (const scale of [chart.options.scales.x, chart.options.scales.y]) {
      scale.title.color = scale.ticks.color = ink();
      scale.grid = {color: context => context.tick && is_decade(context.tick.value) ? (dark.matches ? '#33404b' : '#dfe4ea') : 'transparent'};
    }
  }
  dark.addEventListener('change', () => {
    paint();
    draw();
  });
  // Whole decades about the values.
  const about = values => ({
    min: 10 ** Math.floor(Math.log10(Math.min(...values)) - 1e-9),
    max: 10 ** Math.ceil(Math.log10(Math.max(...values)) + 1e-9)
  });

  const group = () => data.groups[$('group').selectedIndex];
  // Those that no other beats in both, the fastest first.
  const front_of = points =>
      points
          .filter(
              p => !points.some(q => q.x <= p.x && q.error <= p.error && (q.x < p.x || q.error < p.error)))
          .sort((a, b) => a.x - b.x);

  function draw() {
    const g = group(), x = data.metrics.indexOf($('x').value), y = data.metrics.indexOf($('y').value);
    const points = g.samples.filter(s => s.values[x] !== null && s.values[y] !== null).map(s => {
      const seconds = 1e-9 * s.points,
            times = [s.low, s.high].map(t => plain($('x').value === 'seconds' ? t * seconds : t));
      return {
        x: Math.max(s.values[x], least),
        y: Math.max(s.values[y], least),
        error: s.values[y],
        sample: s,
        spread: is_time($('x').value) ? times.join(' to ') : '',
        text: s.name + ': ' + plain(s.values[x]) +
            (is_time($('x').value) ? ' (quartiles ' + times.join(' to ') + ')' : '') + ', ' +
            plain(s.values[y])
      };
    });
    const front = front_of(points);
    const families = [...new Set(points.map(p => p.sample.family))];
    chart.data.datasets = families.map(family => {
      const [colour, shape] = data.looks[family], of_family = points.filter(p => p.sample.family === family);
      return {
        label: family,
        data: of_family,
        pointStyle: shape,
        pointRadius: 6,
        borderColor: colour,
        borderWidth: 2,
        backgroundColor: of_family.map(p => p.sample.single ? 'transparent' : colour)
      };
    });
    chart.data.datasets.push({
      label: 'front',
      type: 'line',
      data: front,
      pointRadius: 0,
      borderDash: [6, 5],
      borderWidth: 1.5,
      borderColor: ink(),
      pointStyle: 'line'
    });
    if (points.length) {
      Object.assign(chart.options.scales.x, about(points.map(p => p.x)));
      Object.assign(chart.options.scales.y, about(points.map(p => p.y)));
    }
    chart.options.scales.x.title.text = g.labels[$('x').value];
    chart.options.scales.y.title.text = g.labels[$('y').value];
    chart.update();
    $('what').textContent = 'Time against error: ' + g.title;
    $('plot').setAttribute(
        'aria-label',
        points.length + ' methods, ' + g.labels[$('y').value] + ' against ' + g.labels[$('x').value]);
    table(points, front);
    document.body.dataset.points = points.length;
    document.body.dataset.front = front.length;
  }

  function table(points, front) {
    const cell = (kind, text, number) => {
      const e = document.createElement(kind);
      e.textContent = text;
      if (number) e.className = 'n';
      return e;
    };
    const row = cells => {
      const tr = document.createElement('tr');
      tr.append(...cells);
      return tr;
    };
    const g = group(), head = document.createElement('thead'), body = document.createElement('tbody');
    head.append(row([
      cell('th', 'method'), cell('th', g.labels[$('x').value], true), cell('th', 'quartiles', true),
      cell('th', g.labels[$('y').value], true), cell('th', 'front')
    ]));
    for (const p of [...points].sort((a, b) => a.x - b.x)) {
      const name = cell('th', p.sample.name);
      name.scope = 'row';
      const tr = row([
        name, cell('td', plain(p.x), true), cell('td', p.spread, true), cell('td', plain(p.error), true),
        cell('td', front.includes(p) ? 'yes' : '')
      ]);
      tr.classList.toggle('front', front.includes(p));
      body.append(tr);
    }
    $('table').replaceChildren(head, body);
  }

  // Another group keeps the metrics where it has them.
  function choose() {
    const g = group();
    const there = data.metrics.filter((m, k) => g.samples.some(s => s.values[k] !== null));
    for (const [id, start] of [['x', g.x], ['y', g.y]]) {
      const old = $(id).dataset.touched && there.includes($(id).value) ? $(id).value : start;
      $(id).replaceChildren(...there.map(m => new Option(g.labels[m], m)));
      if (there.includes(old)) $(id).value = old;
    }
    draw();
  }
  $('group').replaceChildren(...data.groups.map(g => new Option(g.title, g.title)));
  $('group').addEventListener('change', choose);
  for (const id of ['x', 'y'])
    $(id).addEventListener('change', () => {
      $(id).dataset.touched = 1;
      draw();
    });
  $('interactive').hidden = false;
  paint();
  if (data.groups.length) choose();
  chart.resize();
  document.body.dataset.charts = chart.width > 0 ? 1 : 0;
})();
