'use strict';
(() => {
  const {$, data, unique, words, plain, fill} = kit;
  const short = surface => surface.split(':')[0];

  // Routes in the order in which they are offered keep their looks; the methods over meshes come after them.
  const routes = Object.keys(data.routes);
  const look_of = route => kit.look(Math.max(0, routes.indexOf(route)));

  const least = -1, most = 16.5;
  const log_error = e => e === null ? most : Math.min(most, e);
  const errors = e => e === null ? 'no digit' : e <= least ? 'at most 0.1' : plain(10 ** e);
  const chart = kit.picture('plot', {
    x: {title: 'x'},
    y: {title: 'error in roundings'},
    tooltip: {
      title: items => items.length ? 'x = ' + plain(items[0].raw.value) : '',
      label: item => item.dataset.label + ': ' + errors(item.raw.log) + ' ' +
          data.sweeps[$('sweep').value].error.replace('error in ', '')
    }
  });
  const title =
      () => [short($('surface').value), words($('sweep').value), words($('quantity').value)].join(' ');
  kit.offer_picture(chart, title);
  kit.offer_table($('map'), () => 'surfaces by sweeps');

  const chosen = () => data.curves.filter(
      c => c.surface === $('surface').value && c.sweep === $('sweep').value &&
          c.quantity === $('quantity').value);
  function draw() {
    const curves = chosen(), lines = [], sweep = data.sweeps[$('sweep').value];
    const points = (c, values) => values.map((log, i) => {
      const value = sweep.x[c.at ? c.at[i] : i];
      return {
        x: Math.log10(value),
        y: log_error(log),
        value,
        log,
        error: log === null ? null : +(10 ** log).toPrecision(3)
      };
    });
    // The bound of double, else of the first curve that has one.
    const judged = curves.find(c => c.bound && c.bound.some(b => b !== null));
    for (const c of curves) {
      if (kit.hidden.has(c.route)) continue;
      lines.push(kit.line(
          c.route, look_of(c.route), points(c, c.error),
          {pointRadius: 4, borderWidth: c.route === 'double' ? 3 : 1.5}));
      if (c === judged)
        lines.push(kit.line(
            'bound of ' + c.route, {colour: kit.css('ink'), shape: '', dash: [6, 5]},
            points(c, c.bound).filter(p => p.log !== null), {pointRadius: 0, borderWidth: 2.5}));
    }
    chart.data.datasets = lines;
    const all = lines.flatMap(l => l.data);
    if (all.length) {
      kit.limits(chart.options.scales.x, all.map(p => p.x), 0.1);
      Object.assign(
          chart.options.scales.y, {min: least, max: Math.max(2, ...all.map(p => Math.ceil(p.y) + 0.5))});
    }
    chart.options.scales.x.title.text = sweep.unit;
    chart.options.scales.x.reverse = data.falling.includes($('sweep').value);
    chart.options.scales.y.title.text = sweep.error;
    chart.update();
    $('what').textContent = 'Curves: ' + short($('surface').value) + ', ' + words($('sweep').value);
    $('about').textContent = sweep.summary[0].toUpperCase() + sweep.summary.slice(1) + '.';
    $('plot').setAttribute('aria-label', 'Error against ' + sweep.unit + ', ' + curves.length + ' curves.');
    for (const cell of document.querySelectorAll('#map button'))
      cell.parentElement.classList.toggle(
          'chosen', cell.dataset.surface === $('surface').value && cell.dataset.sweep === $('sweep').value);
    document.body.dataset.lines = lines.length;
  }

  // A choice leaves those below it with what still exists.
  function choose() {
    const of_surface = data.curves.filter(c => c.surface === $('surface').value);
    fill($('sweep'), unique(of_surface.map(c => c.sweep)), words);
    const quantities = unique(of_surface.filter(c => c.sweep === $('sweep').value).map(c => c.quantity));
    fill($('quantity'), data.quantities.filter(q => quantities.includes(q)), words);
    kit.legend(
        'legend',
        unique(chosen().map(c => c.route))
            .map(name => ({name, title: data.routes[name], look: look_of(name)})),
        draw);
    draw();
  }
  fill($('surface'), unique(data.curves.map(c => c.surface)), short);
  $('quantity').replaceChildren(new Option('frame', 'frame'));
  for (const id of ['surface', 'sweep', 'quantity']) $(id).addEventListener('change', choose);
  // From a cell of the map, or a finding, to its curves.
  for (const button of document.querySelectorAll('button[data-sweep]'))
    button.addEventListener('click', () => {
      for (const id of ['surface', 'sweep', 'quantity'])
        if (button.dataset[id]) {
          $(id).value = button.dataset[id];
          choose();
        }
      $('interactive').scrollIntoView({block: 'nearest'});
    });
  if (data.curves.length) choose();
  kit.ready(draw);
})();
