#include "converge_report.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <string_view>
#include <tuple>

#include "base/text.h"
#include "csv.h"
#include "html.h"

namespace darboux {

extern const std::string_view chart_js;  // Chart.js, embedded by the build

namespace {

using Json = nlohmann::ordered_json;

std::string_view class_name(const Study& study) {
  return name_in(vertex_class_names, study.vertex_class);
}
std::string_view verdict_name(const Study& study) {
  return name_in(order_verdict_names, study.verdict);
}

// ---- HTML -------------------------------------------------------------------------------------------------

// With two decimals; never "-0.00".
std::string fixed(double x) {
  char buffer[64];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, std::round(100 * x) / 100 + 0.0,
                                std::chars_format::fixed, 2)
                      .ptr};
}

struct Mark {
  std::string_view style, symbol;
};
Mark mark(const Study& study) {
  switch (study.verdict) {
    case OrderVerdict::as_expected:
      return {"good", "✓"};
    case OrderVerdict::faster:
      return {"good", "▲"};
    case OrderVerdict::slower:
      return {"bad", "▼"};
    case OrderVerdict::does_not_converge:
      if (study.holds()) return {"plain", "–"};
      return {"bad", "✕"};
    case OrderVerdict::at_the_floor:
      break;
  }
  return {"plain", "–"};
}

std::string table_row(const Study& study) {
  const bool fitted = std::isfinite(study.order);
  const Level& finest = study.levels.back();
  const Mark m = mark(study);
  std::string row = "<tr class=study";
  for (const auto& [key, value] : {std::pair<std::string_view, std::string_view>{"class", class_name(study)},
                                   {"quantity", study.quantity}})
    row += " data-" + std::string(key) + "=\"" + escape(value) + '"';
  row += "><td>" + escape(class_name(study)) + "<td>" + escape(study.quantity) + "<th scope=row>" +
         escape(study.method) + "<td class=n>" + rounded(finest.rms_deg, 2) + "<td class=n>" +
         (fitted ? fixed(study.order) : "–") + "<td class=n>" +
         (fitted ? fixed(study.order_low) + " to " + fixed(study.order_high) : "–") + "<td class=n>" +
         rounded(study.expected_order, 2) + "<td class=n>" + rounded(finest.floor_deg, 1) +
         "<td><span class=\"verdict " + std::string(m.style) + "\">" + std::string(m.symbol) + ' ' +
         std::string(verdict_name(study)) +
         (study.verdict == OrderVerdict::does_not_converge && study.holds() ? ", as expected" : "") +
         "</span></tr>\n";
  return row;
}

std::string table(std::vector<Study> studies) {
  const auto group = [](const Study& s) { return std::tie(s.surface, s.mesh); };
  std::string rows;
  while (!studies.empty()) {
    const Study first = studies.front();
    const auto others = std::stable_partition(studies.begin(), studies.end(),
                                              [&](const Study& s) { return group(s) == group(first); });
    std::stable_sort(studies.begin(), others, [](const Study& a, const Study& b) {
      return a.vertex_class != b.vertex_class ? a.vertex_class > b.vertex_class : a.quantity > b.quantity;
    });
    rows += "<tbody data-surface=\"" + escape(first.surface) + "\" data-mesh=\"" + escape(first.mesh) +
            "\">\n<tr><th class=group scope=rowgroup colspan=9>" + escape(first.surface) + ", " +
            escape(first.mesh) + " mesh</tr>\n";
    for (auto s = studies.begin(); s != others; ++s) rows += table_row(*s);
    rows += "</tbody>\n";
    studies.erase(studies.begin(), others);
  }
  return rows;
}

// What the page's script reads: the studies, and the names in the order in which they are offered.
Json page_data(const std::vector<Study>& studies) {
  Json methods = Json::array(), families = Json::object();
  for (const FrameMethod& method : frame_methods())
    if (std::any_of(studies.begin(), studies.end(), [&](const Study& s) { return s.method == method.name; }))
      methods.push_back({{"name", method.name}, {"summary", method.summary}});
  for (const MeshFamily& family : mesh_families()) families[std::string(family.name)] = family.summary;
  return {{"studies", studies_json(studies)}, {"methods", methods}, {"families", families}};
}

constexpr std::string_view report_style = R"css(
.lead{font-size:1.05rem}
.sum{font-weight:600}
.controls{display:flex;flex-wrap:wrap;gap:.75rem 1.25rem;border:0;padding:0;margin:0 0 .9rem}
.controls label{display:flex;flex-direction:column;font-size:.85rem;color:var(--soft)}
select{font:inherit;color:var(--ink);background:#fff;border:1px solid #9aa6b4;border-radius:.35rem;
  padding:.25rem .5rem;
  max-width:24rem}
.methods{display:flex;flex-wrap:wrap;gap:.3rem 1.1rem;border:0;padding:0;margin:0 0 .6rem;font-size:.95rem}
.methods label{display:inline-flex;align-items:center;gap:.4rem;cursor:pointer}
.methods svg{flex:none}
.methods .absent{color:var(--soft)}
.plot{position:relative;height:26rem}
.group{padding-top:1rem;font-weight:600;color:var(--accent)}
)css";

constexpr std::string_view script = R"js(
(() => {
'use strict';
const data = JSON.parse(document.getElementById('data').textContent);
const $ = id => document.getElementById(id);

// Okabe and Ito's palette, which colour-blind readers can tell apart; a symbol of its own for
// every method as well.
const colours = ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#b8860b', '#56b4e9', '#000000'];
const symbols = ['circle', 'triangle', 'rect', 'rectRot', 'star', 'crossRot', 'cross'];
const looks = new Map(data.methods.map((m, i) => [m.name, {
  colour: colours[i % colours.length], symbol: symbols[i % symbols.length],
  dash: i < colours.length ? [] : [6, 3], hidden: false}]));

const unique = list => [...new Set(list)];
const fill = (select, values, text = v => v) => {
  const old = select.value;
  select.replaceChildren(...values.map(v => new Option(text(v), v)));
  if (values.includes(old)) select.value = old;
};
const is = (...keys) => s => keys.every(k => s[k] === $(k).value);

// ---- numbers for people
const superscript = e => String(e).replace(/./g, c => c === '-' ? '⁻' : '⁰¹²³⁴⁵⁶⁷⁸⁹'[c]);
const plain = x => {
  if (x >= 0.001 && x < 10000) return String(+x.toPrecision(2));
  const e = Math.floor(Math.log10(x) + 1e-9), m = +(x / 10 ** e).toPrecision(2);
  return (m === 1 ? '' : m + '·') + '10' + superscript(e);
};
const time = s => s >= 1 ? plain(s) + ' s' : s >= 1e-3 ? plain(s * 1e3) + ' ms' : plain(s * 1e6) + ' µs';

// ---- logarithmic axes: decades, or 1, 2, 5 where there are few of them
const ticks = (min, max) => {
  const steps = Math.log10(max / min) > 2.2 ? [1] : [1, 2, 5], result = [];
  for (let e = Math.floor(Math.log10(min)); e <= Math.ceil(Math.log10(max)); ++e)
    for (const s of steps) {
      const value = +(s + 'e' + e);
      if (value >= min && value <= max) result.push({value});
    }
  return result;
};
const axis = (title, format, values) => ({
  type: 'logarithmic', title: {display: true, text: title, font: {size: 13}},
  grid: {color: '#e6eaef'}, border: {color: '#9aa6b4'},
  afterBuildTicks: a => { a.ticks = values ? values().map(value => ({value})) : ticks(a.min, a.max); },
  ticks: {callback: format, font: {size: 12}, maxRotation: 0, autoSkip: false}});
const limits = (axis, values, below, above = below) => {
  axis.min = Math.min(...values) / below;
  axis.max = Math.max(...values) * above;
};

// ---- the slopes 1 and 2, from above the largest error at the coarsest mesh downwards
const each_guide = (chart, draw) => {
  const {ctx, chartArea: area, scales: {x, y}, $anchor: anchor} = chart;
  if (!anchor) return;
  ctx.save();
  ctx.beginPath();
  ctx.rect(area.left, area.top, area.width, area.height);
  ctx.clip();
  ctx.font = '12px system-ui, sans-serif';
  for (const slope of [1, 2]) draw(ctx, x, y, slope, h => anchor.y * (h / anchor.x) ** slope);
  ctx.restore();
};
const guides = {
  id: 'guides',
  beforeDatasetsDraw: chart => each_guide(chart, (ctx, x, y, slope, at) => {
    ctx.strokeStyle = '#7b8794';
    ctx.setLineDash([5, 5]);
    ctx.beginPath();
    ctx.moveTo(x.getPixelForValue(x.max), y.getPixelForValue(at(x.max)));
    ctx.lineTo(x.getPixelForValue(x.min), y.getPixelForValue(at(x.min)));
    ctx.stroke();
  }),
  // The label stands above the line where that leaves the picture, at the left or at the bottom.
  afterDatasetsDraw: chart => each_guide(chart, (ctx, x, y, slope, at) => {
    const h = Math.max(x.min, chart.$anchor.x * (y.min / chart.$anchor.y) ** (1 / slope));
    const text = 'order ' + slope, left = x.getPixelForValue(h) + 8;
    const base = y.getPixelForValue(at(x.getValueForPixel(left + ctx.measureText(text).width))) - 5;
    ctx.lineWidth = 4;
    ctx.strokeStyle = '#fff';
    ctx.strokeText(text, left, base);
    ctx.fillStyle = '#5a6675';
    ctx.fillText(text, left, base);
  })};

const tooltip = {callbacks: {
  title: items => items.length ? 'n = ' + items[0].raw.level.n : '',
  label: item => {
    const l = item.raw.level;
    return [item.dataset.label + ': rms ' + plain(l.rms_deg) + '°, p95 ' + plain(l.p95_deg) + '°, max ' +
            plain(l.max_deg) + '°', '  in ' + time(l.seconds) + (l.used ? '' : ', not in the fit')];
  }}};
const make = (id, x, y, plugins) => new Chart($(id), {
  type: 'line', data: {datasets: []}, plugins,
  options: {animation: false, responsive: true, maintainAspectRatio: false, parsing: false,
            interaction: {mode: 'nearest', intersect: false}, scales: {x, y},
            plugins: {legend: {display: false}, tooltip}}});

let widths = [];
const against_h = make('against-h', axis('mesh width h, finer to the left',
  h => '1/' + Math.round(1 / h), () => widths),
                       axis('error in degrees', plain), [guides]);
const against_time = make('against-time', axis('run time of the method on the whole mesh', time),
                          axis('error in degrees', plain), []);

const levels = s => s.resolutions.map((n, i) => ({
  n, h: s.h[i], rms_deg: s.rms_deg[i], p95_deg: s.p95_deg[i], max_deg: s.max_deg[i], seconds: s.seconds[i],
  used: s.used[i]}));

function draw() {
  const statistic = $('statistic').value + '_deg';
  const chosen = data.studies.filter(is('surface', 'mesh', 'class', 'quantity'));
  const floor = chosen.filter(s => s.verdict === 'at the floor');
  const drawn = chosen.filter(s => !floor.includes(s) && !looks.get(s.method).hidden);
  // Lines that lie upon each other: those beneath are drawn wider.
  const same = (s, t) => s.resolutions.length === t.resolutions.length &&
    s[statistic].every((y, i) => Math.abs(y - t[statistic][i]) <= 0.03 * y);
  const lines = key => drawn.map((s, index) => {
    const look = looks.get(s.method);
    const beneath = key === 'h' ? drawn.slice(0, index).filter(t => same(s, t)).length : 0;
    const points = levels(s).filter(l => l[statistic] > 0)
      .map(level => ({x: level[key], y: level[statistic], level}));
    const cross = look.symbol === 'star' || look.symbol.startsWith('cross');
    return {label: s.method, data: points, borderColor: look.colour, borderWidth: 2 + 3 * beneath,
      borderDash: look.dash,
            pointStyle: look.symbol, pointRadius: (cross ? 6 : 5) + 2.5 * beneath, pointHoverRadius: 9,
            pointBorderWidth: cross ? 2 : 1.5,
            pointBackgroundColor: points.map(p => p.level.used ? look.colour : '#fff')};
  });
  for (const [chart, key] of [[against_h, 'h'], [against_time, 'seconds']]) {
    chart.data.datasets = lines(key);
    const points = chart.data.datasets.flatMap(d => d.data);
    if (points.length) {
      limits(chart.options.scales.x, points.map(p => p.x), 1.25);
      limits(chart.options.scales.y, points.map(p => p.y), 1.6, chart === against_h ? 3.2 : 1.6);
    }
    if (chart === against_h) {
      widths = unique(points.map(p => p.x));
      const coarsest = Math.max(...widths), there = points.filter(p => p.x === coarsest);
      chart.$anchor = points.length ? {x: coarsest, y: 2.2 * Math.max(...there.map(p => p.y))} : null;
    }
    chart.update();
  }
  const what = $('quantity').value + ', ' + $('class').value + ' vertices, ' + $('surface').value + ', ' +
               $('mesh').value + ' mesh';
  $('against-h').setAttribute('aria-label',
    'Error against mesh width: ' + what + '. The numbers are in the table.');
  $('against-time').setAttribute('aria-label', 'Error against run time: ' + what + '.');
  $('about-mesh').textContent = 'Mesh: ' + (data.families[$('mesh').value] || '') + '.';
  $('at-floor').textContent = floor.length
    ? 'Not drawn, because their error is nothing but rounding (about ' +
      plain(Math.max(...floor.map(s => s.floor_deg))) + '° or less): ' +
      floor.map(s => s.method).join(', ') +
      '.' : '';
  for (const label of document.querySelectorAll('.methods label'))
    label.classList.toggle('absent',
      !chosen.some(s => s.method === label.dataset.method && !floor.includes(s)));
  document.body.dataset.lines = drawn.length;
  filter();
}

function filter() {
  const only = $('only').checked;
  for (const body of document.querySelectorAll('#studies tbody'))
    body.hidden = only && !(body.dataset.surface === $('surface').value &&
      body.dataset.mesh === $('mesh').value);
  for (const row of document.querySelectorAll('#studies tr.study'))
    row.hidden = only && !(row.dataset.class === $('class').value &&
      row.dataset.quantity === $('quantity').value);
}

// A choice leaves those below it with what still exists.
function choose() {
  fill($('mesh'), unique(data.studies.filter(is('surface')).map(s => s.mesh)));
  const classes = unique(data.studies.filter(is('surface', 'mesh')).map(s => s.class));
  fill($('class'), classes.includes('interior') ? unique(['interior', ...classes]) : classes,
    v => v.replace('_', ' '));
  fill($('quantity'), unique(data.studies.filter(is('surface', 'mesh', 'class')).map(s => s.quantity))
                          .sort().reverse());
  draw();
}

// ---- the legend: a check box a method
const icon = {circle: '<circle cx="16" cy="7" r="4.5"/>', triangle: '<path d="M16 2l5 9h-10z"/>',
  rect: '<path d="M12 3h8v8h-8z"/>', rectRot: '<path d="M16 1.5l5.5 5.5-5.5 5.5-5.5-5.5z"/>',
  star: '<path d="M16 1v12M10 7h12M12 3l8 8M20 3l-8 8"/>', crossRot: '<path d="M12 3l8 8M20 3l-8 8"/>',
  cross: '<path d="M16 1v12M10 7h12"/>'};
for (const method of data.methods) {
  const look = looks.get(method.name), label = document.createElement('label'),
    box = document.createElement('input');
  box.type = 'checkbox';
  box.checked = true;
  box.addEventListener('change', () => { look.hidden = !box.checked; draw(); });
  label.dataset.method = method.name;
  label.title = method.summary;
  label.innerHTML = `<svg width="32" height="14" stroke="${look.colour}" fill="${look.colour}"
    stroke-width="2"
    aria-hidden="true"><path d="M0 7h32"
    stroke-dasharray="${look.dash.join(' ')}"/>${icon[look.symbol]}</svg>`;
  label.prepend(box);
  label.append(method.name);
  $('methods').append(label);
}

fill($('surface'), unique(data.studies.map(s => s.surface)));
for (const id of ['surface', 'mesh', 'class', 'quantity', 'statistic'])
  $(id).addEventListener('change', choose);
$('only').addEventListener('change', filter);
choose();
$('interactive').hidden = false;
$('only').parentElement.hidden = false;
against_h.resize();
against_time.resize();
document.body.dataset.charts = [against_h, against_time].filter(c => c.width > 0).length;
})();
)js";

}  // namespace

nlohmann::ordered_json studies_json(const std::vector<Study>& studies) {
  Json list = Json::array();
  for (const Study& s : studies) {
    const auto column = [&](auto member) {
      Json values = Json::array();
      for (const Level& level : s.levels) values.push_back(level.*member);
      return values;
    };
    const auto number = [](double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); };
    list.push_back({{"surface", s.surface},
                    {"v_range", {s.v_first, s.v_last}},
                    {"mesh", s.mesh},
                    {"method", s.method},
                    {"class", class_name(s)},
                    {"quantity", s.quantity},
                    {"resolutions", column(&Level::resolution)},
                    {"h", column(&Level::h)},
                    {"max_deg", column(&Level::max_deg)},
                    {"rms_deg", column(&Level::rms_deg)},
                    {"p95_deg", column(&Level::p95_deg)},
                    {"rms_deg_of_mesh", column(&Level::rms_of_mesh)},
                    {"seconds", column(&Level::seconds)},
                    {"corners", column(&Level::corners)},
                    {"fallback_corners", column(&Level::fallback)},
                    {"used", column(&Level::used)},
                    {"order", number(s.order)},
                    {"order_ci", {number(s.order_low), number(s.order_high)}},
                    {"max_order", number(s.max_order)},
                    {"expected_order", s.expected_order},
                    {"floor_deg", s.levels.back().floor_deg},
                    {"floors_deg", column(&Level::floor_deg)},
                    {"verdict", verdict_name(s)}});
  }
  return list;
}

std::string studies_csv(const std::vector<Study>& studies) {
  std::string text =
      "surface,mesh,method,class,quantity,resolution,h,max_deg,rms_deg,rms_deg_least,rms_deg_most,p95_deg,"
      "floor_deg,seconds,corners,fallback_corners,used,order,order_low,order_high,max_order,expected_order,"
      "verdict\r\n";
  for (const Study& s : studies)
    for (const Level& l : s.levels) {
      for (const std::string_view field :
           {std::string_view(s.surface), s.mesh, s.method, class_name(s), s.quantity})
        text += csv_text(field) + ',';
      text += std::to_string(l.resolution);
      const auto [least, most] = std::minmax_element(l.rms_of_mesh.begin(), l.rms_of_mesh.end());
      for (const double x : {l.h, l.max_deg, l.rms_deg, *least, *most, l.p95_deg, l.floor_deg, l.seconds})
        text += ',' + csv_number(x);
      text +=
          ',' + std::to_string(l.corners) + ',' + std::to_string(l.fallback) + (l.used ? ",true" : ",false");
      for (const double x : {s.order, s.order_low, s.order_high, s.max_order, s.expected_order})
        text += ',' + csv_number(x);
      text += ',' + csv_text(verdict_name(s)) + "\r\n";
    }
  return text;
}

std::string verdict_summary(const std::vector<Study>& studies) {
  std::string text = std::to_string(studies.size()) + (studies.size() == 1 ? " study" : " studies");
  const char* separator = ": ";
  const auto add = [&](OrderVerdict verdict, bool holds, const char* words) {
    const auto count = std::count_if(studies.begin(), studies.end(), [&](const Study& s) {
      return s.verdict == verdict && s.holds() == holds;
    });
    if (count == 0) return;
    text += separator + std::to_string(count) + ' ' + words;
    separator = ", ";
  };
  add(OrderVerdict::as_expected, true, "as expected");
  add(OrderVerdict::faster, true, "faster");
  add(OrderVerdict::at_the_floor, true, "at the floor");
  add(OrderVerdict::does_not_converge, true, "not converging, as expected");
  add(OrderVerdict::slower, false, "slower than expected");
  add(OrderVerdict::does_not_converge, false, "not converging, though expected to");
  const auto rare = std::count_if(studies.begin(), studies.end(), [](const Study& s) {
    return s.verdict != OrderVerdict::does_not_converge && !s.max_converges();
  });
  if (rare > 0) text += "; of " + std::to_string(rare) + " that converge the largest error does not";
  return text;
}

namespace {

// Orders of the tangents on one family of meshes of one surface.
struct OrderTable {
  std::string surface, mesh;
  std::vector<std::string_view> classes, methods;
  std::map<std::pair<std::string_view, std::string_view>, std::string> cells;  // of method and class

  std::string cell(std::string_view method, std::string_view of_class) const {
    const auto found = cells.find({method, of_class});
    return found == cells.end() ? "" : found->second;
  }
};

// "2.00 [1.99, 2.01] !": !: less than expected; *: the largest error does not converge
std::string order_cell(const Study& s) {
  if (s.verdict == OrderVerdict::at_the_floor) return "at the floor";
  const std::string mark = !s.holds() ? " !" : s.max_converges() ? "" : " *";
  if (s.verdict == OrderVerdict::does_not_converge) return s.holds() ? "does not converge" : "none" + mark;
  return fixed(s.order) + " [" + fixed(s.order_low) + ", " + fixed(s.order_high) + ']' + mark;
}

std::vector<OrderTable> order_tables(const std::vector<Study>& studies) {
  std::vector<OrderTable> tables;
  std::vector<std::map<VertexClass, bool, std::greater<>>> classes;
  for (const Study& s : studies) {
    if (tables.empty() || s.surface != tables.back().surface || s.mesh != tables.back().mesh) {
      tables.push_back({s.surface, std::string(s.mesh), {}, {}, {}});
      classes.emplace_back();
    }
    if (s.quantity != "tangent") continue;
    OrderTable& table = tables.back();
    if (std::find(table.methods.begin(), table.methods.end(), s.method) == table.methods.end())
      table.methods.push_back(s.method);
    classes.back()[s.vertex_class] = true;
    table.cells[{s.method, class_name(s)}] = order_cell(s);
  }
  for (std::size_t i = 0; i < tables.size(); ++i)
    for (const auto& [of_class, there] : classes[i])
      tables[i].classes.push_back(name_in(vertex_class_names, of_class));
  return tables;
}

}  // namespace

std::string orders_text(const std::vector<Study>& studies) {
  std::string text = "Order of convergence of the tangents, with its 95 % interval:\n";
  for (const OrderTable& table : order_tables(studies)) {
    text += '\n' + table.surface + ", " + table.mesh + "\n  " + std::string(18, ' ');
    for (const std::string_view of_class : table.classes) text += ' ' + padded(std::string(of_class), 20);
    for (const std::string_view method : table.methods) {
      text += "\n  " + padded(std::string(method), 18);
      for (const std::string_view of_class : table.classes)
        text += ' ' + padded(table.cell(method, of_class), 20);
    }
    text += '\n';
  }
  return text + '\n';
}

std::vector<std::string> unexpected(const std::vector<Study>& studies) {
  std::vector<std::string> lines;
  for (const Study& s : studies) {
    if (s.holds()) continue;
    char numbers[80];
    std::snprintf(numbers, sizeof numbers, "order %.2f [%.2f, %.2f], expected %g", s.order, s.order_low,
                  s.order_high, s.expected_order);
    lines.push_back(std::string(verdict_name(s)) + ": " + s.surface + ", " + std::string(s.mesh) + " mesh, " +
                    std::string(s.method) + ", " + std::string(s.quantity) + " of the " +
                    std::string(class_name(s)) + ": " + numbers);
  }
  return lines;
}

std::string converge_markdown(const std::vector<Study>& studies, const Provenance& p) {
  std::string text = "# Orders of convergence\n\n" + verdict_summary(studies) +
                     ".\n\nOf the tangents, with their 95 % intervals; !: below what is expected.\n";
  for (const OrderTable& table : order_tables(studies)) {
    text += "\n## " + table.surface + ", " + table.mesh + "\n\n| method |";
    for (const std::string_view of_class : table.classes) text += ' ' + std::string(of_class) + " |";
    text += "\n|---|";
    for (std::size_t i = 0; i < table.classes.size(); ++i) text += "---|";
    for (const std::string_view method : table.methods) {
      text += "\n| " + std::string(method) + " |";
      for (const std::string_view of_class : table.classes) text += ' ' + table.cell(method, of_class) + " |";
    }
    text += '\n';
  }
  if (const auto lines = unexpected(studies); !lines.empty()) {
    text += "\n## Not as expected\n\n";
    for (const std::string& line : lines) text += "- " + line + '\n';
  }
  return text + "\nMade by `" + p.command + "`: Darboux " + p.version + ", " + p.compiler + ", " + p.machine +
         ", " + p.date + ".\n";
}

std::string converge_page(const std::vector<Study>& studies, const Provenance& p) {
  std::string page = R"html(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Darboux: convergence of mesh frames</title>
<link rel="icon" href="data:,">
<style>)html";
  page += page_style;
  page += report_style;
  page += R"html(</style>
</head>
<body>
<main>
<h1>How wrong are the tangents of a mesh, and how fast do they get better?</h1>
<p class=lead>A normal map needs a tangent and a bitangent at every vertex: the directions in which its
texture runs over the surface. Software computes them from triangles, each in its own way. Here triangles
are laid on surfaces whose true directions are known exactly, finer and finer, and every method's result is
compared with the truth. The error is an angle. <b>Order 1</b> means that half the mesh width halves the
error,
<b>order 2</b> that it quarters it.</p>
<p class=sum>)html" +
          escape(verdict_summary(studies)) + R"html(.</p>
<noscript><p class=card>The pictures need JavaScript. All results are in the table below.</p></noscript>
<section class=card id=interactive hidden>
<h2>Pictures</h2>
<p class=soft id=about-mesh></p>
<div class=controls>
<label>Surface <select id=surface></select></label>
<label>Mesh <select id=mesh></select></label>
<label>Vertices <select id=class></select></label>
<label>Quantity <select id=quantity></select></label>
<label>Error <select id=statistic><option value=rms>root mean square<option value=p95>95 % are below
<option value=max>largest</select></label>
</div>
<fieldset class=methods id=methods aria-label="Methods that are drawn"></fieldset>
<div class=pictures>
<figure><div class=plot><canvas id=against-h role=img></canvas></div>
<figcaption>Error against mesh width. Parallel to a dashed line means that order. Hollow points are not part
of the fit.</figcaption></figure>
<figure><div class=plot><canvas id=against-time role=img></canvas></div>
<figcaption>Error against run time, one thread. Further left is faster,
further down is more accurate.</figcaption>
</figure>
</div>
<p class=soft id=at-floor aria-live=polite></p>
</section>
<section class=card>
<h2>All studies</h2>
<p class=soft>The order is the slope of the logarithm of the root mean square error over that of the mesh
width, with its 95&nbsp;% confidence interval. The error is that of the finest mesh. The floor is what
rounding alone may cause there; a study that reaches it has no order. Angles in degrees.</p>
<label class=soft hidden><input type=checkbox id=only checked> only what the pictures show</label>
<div class=scroll>
<table id=studies>
<thead><tr><th scope=col>vertices<th scope=col>quantity<th scope=col>method<th scope=col class=n>error
<th scope=col class=n>order<th scope=col class=n>95&nbsp;% interval<th scope=col class=n>expected
<th scope=col class=n>floor
<th scope=col>verdict</tr></thead>
)html";
  page += table(studies);
  page += "</table>\n</div>\n</section>\n" + provenance_html(p) + "</main>\n";
  page += "<script type=\"application/json\" id=data>" + script_json(page_data(studies)) + "</script>\n";
  page +=
      "<script>addEventListener('error', e => { document.body.dataset.error = e.message; "
      "});</script>\n<script>";
  page += chart_js;
  page += "</script>\n<script>";
  page += script;
  page += "</script>\n</body>\n</html>\n";
  return page;
}

}  // namespace darboux
