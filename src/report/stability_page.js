'use strict';
addEventListener('error', e => {
  document.body.dataset.error = e.message;
});

(() => {
  const data = JSON.parse(document.getElementById('data').textContent);
  const $ = id => document.getElementById(id);
  const unique = list => [...new Set(list)];
  const words = name => name.replaceAll('_', ' ');
  const short = surface => surface.split(':')[0];

  // Okabe and Ito's palette, which colour-blind readers can tell apart, and a symbol for every route.
  const looks = {
    double: ['#0072b2', 'circle'],
    float: ['#56b4e9', 'rect'],
    naive: ['#d55e00', 'triangle'],
    dual: ['#009e73', 'rectRot'],
    central2: ['#e69f00', 'crossRot'],
    central4: ['#cc79a7', 'crossRot'],
    central6: ['#7f7f7f', 'crossRot'],
    central8: ['#b08900', 'crossRot'],
    ridders: ['#8c6d31', 'star']
  };

  // The methods over meshes: the same colours again, another symbol for each round.
  const rounds = ['circle', 'triangle', 'rectRot', 'star'],
        colours = ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#56b4e9', '#7f7f7f'];
  const others = Object.keys(data.routes).filter(r => !looks[r]);
  const look_of = route => looks[route] ||
      (i => [colours[i % colours.length], rounds[Math.floor(i / colours.length) % rounds.length]])(
                               others.indexOf(route));

  // ---- logarithms as numbers: 600 decades are more than a logarithmic axis takes
  const least = -1, most = 16.5;
  const superscript = e => String(e).replace(/./g, c => c === '-' ? '⁻' : '⁰¹²³⁴⁵⁶⁷⁸⁹'[c]);
  const power = e => e === 0 ? '1' : '10' + superscript(e);
  const log_x = x => Math.log10(x);
  const log_error = e => e === null ? most : Math.min(most, e);
  const roundings = e => e === null ? 'no digit' : e <= least ? 'at most 0.1' : plain(10 ** e);
  const plain = x => x >= 0.001 && x < 10000 ? String(+x.toPrecision(3)) : x.toExponential(1);

  const dark = matchMedia('(prefers-color-scheme: dark)');
  const ink = () => getComputedStyle(document.body).getPropertyValue('--soft');
  const axis = title => ({
    type: 'linear',
    title: {display: true, text: title, color: ink()},
    grid: {color: dark.matches ? '#2b343d' : '#e4e8ee'},
    ticks: {color: ink(), maxTicksLimit: 12, callback: e => Number.isInteger(e) ? power(e) : ''}
  });
  const chart = new Chart($('plot'), {
    type: 'line',
    data: {datasets: []},
    options: {
      animation: false,
      responsive: true,
      maintainAspectRatio: false,
      parsing: false,
      interaction: {mode: 'nearest', intersect: false},
      scales: {x: axis('x'), y: {...axis('error in roundings'), min: least, max: most}},
      plugins: {
        legend: {labels: {color: ink(), usePointStyle: true}},
        tooltip: {
          callbacks: {
            title: items => items.length ? 'x = ' + plain(items[0].raw.value) : '',
            label: item => item.dataset.label + ': ' + roundings(item.raw.error) + ' roundings'
          }
        }
      }
    }
  });

  const chosen = () => data.curves.filter(
      c => c.surface === $('surface').value && c.sweep === $('sweep').value &&
          c.quantity === $('quantity').value);
  function draw() {
    const curves = chosen(), lines = [];
    const grid = data.sweeps[$('sweep').value].x;
    const points = (c, values) => values.map((e, i) => {
      const x = grid[c.at ? c.at[i] : i];
      return {x: log_x(x), y: log_error(e), value: x, error: e};
    });
    // The bound of double, else of the first curve that has one.
    const judged = curves.find(c => c.bound && c.bound.some(b => b !== null));
    for (const c of curves) {
      const [colour, symbol] = look_of(c.route);
      lines.push({
        label: c.route,
        borderColor: colour,
        backgroundColor: colour,
        pointStyle: symbol,
        pointRadius: 4,
        borderWidth: c.route === 'double' ? 3 : 1.5,
        data: points(c, c.error)
      });
      if (c !== judged) continue;
      lines.push({
        label: 'bound of ' + c.route,
        borderColor: ink(),
        borderDash: [6, 5],
        pointRadius: 0,
        borderWidth: 1.5,
        pointStyle: 'line',
        data: points(c, c.bound).filter(p => p.error !== null)
      });
    }
    const sweep = data.sweeps[$('sweep').value];
    chart.data.datasets = lines;
    chart.options.scales.y.title.text = sweep.error;
    const heights = lines.flatMap(l => l.data.map(p => Math.ceil(p.y) + 0.5));
    chart.options.scales.y.max = Math.min(most, Math.max(4, ...heights));
    chart.options.scales.x.title.text = sweep.unit;
    // From easy, at the left, to hard.
    chart.options.scales.x.reverse = [
      'pole_distance', 'seam_distance', 'edge_distance', 'knot_distance', 'slivers', 'points', 'coverage'
    ].includes($('sweep').value);
    chart.update();
    $('what').textContent = 'Curves: ' + short($('surface').value) + ', ' + words($('sweep').value);
    const named = unique(curves.map(c => c.route)).filter(r => looks[r]).map(r => r + ': ' + data.routes[r]);
    $('about').textContent = sweep.summary[0].toUpperCase() + sweep.summary.slice(1) + '. ' +
        (named.length ? named.join('; ') + '.' :
                        'The methods are those of darboux tangents --list, and fit.');
    $('plot').setAttribute(
        'aria-label', 'Error in roundings against ' + sweep.unit + ', ' + curves.length + ' curves.');
    for (const cell of document.querySelectorAll('#map button'))
      cell.parentElement.classList.toggle(
          'chosen', cell.dataset.surface === $('surface').value && cell.dataset.sweep === $('sweep').value);
    document.body.dataset.lines = lines.length;
  }

  const fill = (select, values, text) => {
    const old = select.value;
    select.replaceChildren(...values.map(v => new Option(text(v), v)));
    if (values.includes(old)) select.value = old;
  };
  // A choice leaves those below it with what still exists.
  function choose() {
    const of_surface = data.curves.filter(c => c.surface === $('surface').value);
    fill($('sweep'), unique(of_surface.map(c => c.sweep)), words);
    const quantities = unique(of_surface.filter(c => c.sweep === $('sweep').value).map(c => c.quantity));
    fill($('quantity'), data.quantities.filter(q => quantities.includes(q)), words);
    draw();
  }
  fill($('surface'), unique(data.curves.map(c => c.surface)), short);
  $('quantity').replaceChildren(new Option('frame', 'frame'));
  for (const id of ['surface', 'sweep', 'quantity']) $(id).addEventListener('change', choose);
  for (const cell of document.querySelectorAll('#map button'))
    cell.addEventListener('click', () => {
      $('surface').value = cell.dataset.surface;
      choose();
      $('sweep').value = cell.dataset.sweep;
      choose();
      $('interactive').scrollIntoView({block: 'nearest'});
    });
  $('interactive').hidden = false;
  choose();
  chart.resize();
  document.body.dataset.charts = chart.width > 0 ? 1 : 0;
})();
