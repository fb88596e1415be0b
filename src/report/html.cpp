#include "html.h"

#include "base/base64.h"

namespace darboux {

std::string escape(std::string_view given) {
  using Json = nlohmann::json;
  // Invalid UTF-8 becomes U+FFFD.
  const std::string text =
      Json::parse(Json(given).dump(-1, ' ', false, Json::error_handler_t::replace)).get<std::string>();
  std::string result;
  for (const char c : text) switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      case '\'':
        result += "&#39;";
        break;
      default:
        result += c;
    }
  return result;
}

std::string script_json(const nlohmann::ordered_json& json) {
  std::string result;
  for (const char c : json.dump(-1, ' ', true, nlohmann::ordered_json::error_handler_t::replace))
    result += c == '<' ? "\\u003c" : std::string(1, c);
  return result;
}

std::string content_policy(const std::vector<std::string_view>& sha256) {
  std::string scripts;
  for (const std::string_view hex : sha256) {
    std::string bytes;
    for (std::size_t i = 0; i < hex.size(); i += 2)
      bytes += static_cast<char>(std::stoi(std::string(hex.substr(i, 2)), nullptr, 16));
    scripts += " 'sha256-" + base64(bytes) + "'";
  }
  return "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src "
         "'unsafe-inline'; "
         "img-src data:; base-uri 'none'; form-action 'none'; script-src" +
         scripts + "\">\n";
}

const std::string_view page_style = R"css(
:root{color-scheme:light;--ink:#1d2733;--soft:#5a6675;--line:#d8dee6;--faint:#edf0f4;--accent:#0072b2;
  --page:#f5f7f9;--card:#fff;--good:#dcecf7;--good-ink:#00486f;--bad:#fbe0d3;--bad-ink:#8a3300;
  --plain:#eceff2;--plain-ink:#48535f}
@media screen and (prefers-color-scheme:dark){:root.both{color-scheme:dark;
  --ink:#e4e9ee;--soft:#a3afbb;--line:#3a4550;--faint:#2b343d;--accent:#6fb8e6;--page:#12171c;--card:#1b2229;
  --good:#123a54;--good-ink:#bfe1f6;--bad:#57250a;--bad-ink:#ffd3bd;--plain:#2b343d;--plain-ink:#c3ccd5}}
*{box-sizing:border-box}
body{margin:0;background:var(--page);color:var(--ink);
  font:16px/1.5 system-ui,"Segoe UI","DejaVu Sans",sans-serif}
main{max-width:78rem;margin:0 auto;padding:2rem 1.5rem 3rem}
h1{font-size:1.75rem;line-height:1.2;margin:0 0 .75rem}
h2{font-size:1.15rem;margin:0 0 .25rem}
p{margin:0 0 1rem;max-width:50rem}
.soft,figcaption{color:var(--soft);font-size:.9rem}
.card{background:var(--card);border:1px solid var(--line);border-radius:.6rem;
  padding:1.1rem 1.25rem;margin:0 0 1.25rem}
:focus-visible{outline:3px solid var(--accent);outline-offset:2px}
.pictures{margin:0 0 .75rem;display:grid;
  grid-template-columns:repeat(auto-fit,minmax(min(100%,26rem),1fr));gap:1.5rem}
figure{margin:0;min-width:0}
.scroll{overflow-x:auto}
table{border-collapse:collapse;width:100%;font-size:.9rem}
th,td{text-align:left;padding:.3rem .5rem;white-space:nowrap;font-weight:400}
thead th{color:var(--soft);border-bottom:2px solid var(--line);vertical-align:bottom}
tbody td,tbody th{border-bottom:1px solid var(--faint)}
th[scope=row]{font-weight:600}
.n{text-align:right;font-variant-numeric:tabular-nums}
.verdict{display:inline-block;border-radius:1rem;padding:0 .6rem}
.good{background:var(--good);color:var(--good-ink)}
.bad{background:var(--bad);color:var(--bad-ink);font-weight:600}
.plain{background:var(--plain);color:var(--plain-ink)}
dl{display:grid;grid-template-columns:max-content 1fr;gap:.2rem 1rem;margin:0;font-size:.9rem}
dt{color:var(--soft)}
dd{margin:0;overflow-wrap:anywhere}
code{font:.88em ui-monospace,"DejaVu Sans Mono",monospace}
@media print{body{background:#fff}.card{break-inside:avoid}}
)css";

}  // namespace darboux
