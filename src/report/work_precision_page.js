'use strict';
(() => {
  const {$, data, unique, words, element, plain} = kit;
  const least = 1e-17;  // what is below it, as no error at all, is drawn there
  const is_time = metric => metric === 'time_ns' || metric === 'seconds';
  const look_of = family => ({colour: data.looks[family][0], shape: data.looks[family][1], dash: []});
  const group = () => data.groups[$('group').selectedIndex];

  const chart =
      kit.picture('plot', {x: {}, y: {}, tooltip: {title: () => '', label: item => item.raw.text || ''}});
  const title =
      () => [group().labels[$('y').value], 'against', group().labels[$('x').value], group().title].join(' ');
  kit.offer_picture(chart, title);

  // Those that no other beats in both, in the order of x.
  const front_of = points =>
      points
          .filter(
              p => !points.some(
                  q => q.value <= p.value && q.error <= p.error && (q.value < p.value || q.error < p.error)))
          .sort((a, b) => a.value - b.value);

  function draw() {
    const g = group(), x = data.metrics.indexOf($('x').value), y = data.metrics.indexOf($('y').value);
    const points = g.samples.filter(s => s.values[x] !== null && s.values[y] !== null).map(s => {
      const seconds = 1e-9 * s.points;
      const times = [s.low, s.high].map(t => plain($('x').value === 'seconds' ? t * seconds : t));
      return {
        value: s.values[x],
        error: s.values[y],
        x: Math.log10(Math.max(s.values[x], least)),
        y: Math.log10(Math.max(s.values[y], least)),
        sample: s,
        spread: is_time($('x').value) ? times.join(' to ') : '',
        text: s.name + ': ' + plain(s.values[x]) +
            (is_time($('x').value) ? ' (quartiles ' + times.join(' to ') + ')' : '') + ', ' +
            plain(s.values[y])
      };
    });
    const front = front_of(points);
    const drawn = points.filter(p => !kit.hidden.has(p.sample.family));
    chart.data.datasets = unique(drawn.map(p => p.sample.family))
                              .map(
                                  family => kit.line(
                                      family, look_of(family), drawn.filter(p => p.sample.family === family),
                                      {open: p => p.sample.single, showLine: false}));
    chart.data.datasets.push(kit.line(
        'front', {colour: kit.css('soft'), shape: '', dash: [6, 5]}, front,
        {pointRadius: 0, borderWidth: 1.5}));
    if (drawn.length) {
      const {x: across, y: up} = chart.options.scales;
      kit.limits(across, drawn.map(p => p.x), 0.15);
      kit.limits(up, drawn.map(p => p.y), 0.3);
    }
    chart.options.scales.x.title.text = g.labels[$('x').value];
    chart.options.scales.y.title.text = g.labels[$('y').value];
    chart.update();
    $('what').textContent = g.title + ': ' + g.labels[$('y').value] + ' against ' + g.labels[$('x').value];
    $('plot').setAttribute(
        'aria-label',
        points.length + ' methods, ' + g.labels[$('y').value] + ' against ' + g.labels[$('x').value]);
    tabulate(points, front);
    document.body.dataset.points = points.length;
    document.body.dataset.front = front.length;
  }

  let table = null;
  function tabulate(points, front) {
    const g = group();
    if (!table)
      table = kit.table(
          $('table'),
          [
            {name: 'method', value: r => r.point.sample.name},
            {name: 'across', number: true, value: r => r.point.value},
            {name: 'quartiles', number: true, value: r => r.point.sample.low},
            {name: 'upwards', number: true, value: r => r.point.error},
            {name: 'front', value: r => r.front ? 0 : 1}
          ],
          {find: $('find')});
    $('table').querySelectorAll('thead .sort')[1].textContent = g.labels[$('x').value];
    $('table').querySelectorAll('thead .sort')[3].textContent = g.labels[$('y').value];
    const cell = (text, number) => element('td', {textContent: text, className: number ? 'n' : ''});
    table.set([...points]
                  .sort((a, b) => a.value - b.value)
                  .map(point => ({
                         point,
                         front: front.includes(point),
                         text: (point.sample.name + ' ' + point.sample.family).toLowerCase(),
                         make() {
                           return element(
                               'tr', {}, element('th', {scope: 'row', textContent: point.sample.name}),
                               cell(plain(point.value), true), cell(point.spread, true),
                               cell(plain(point.error), true), cell(this.front ? 'yes' : ''));
                         }
                       })));
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
    kit.legend(
        'legend',
        unique(g.samples.map(s => s.family)).map(name => ({name, look: {...look_of(name), line: false}})),
        draw);
    draw();
  }
  $('group').replaceChildren(...data.groups.map(g => new Option(g.title, g.title)));
  $('group').addEventListener('change', choose);
  for (const id of ['x', 'y'])
    $(id).addEventListener('change', () => {
      $(id).dataset.touched = 1;
      draw();
    });
  if (data.groups.length) choose();
  kit.offer_table($('table'), title);
  kit.ready(draw);
})();
