#include "report_page.h"

#include "html.h"

namespace darboux {

extern const std::string_view chart_js, chart_js_sha256;  // Chart.js, embedded by the build
extern const std::string_view page_kit_js, page_kit_js_sha256;

namespace {

constexpr std::string_view kit_style = R"css(
.lead{font-size:1.05rem}
.sum{font-weight:600}
.controls{display:flex;flex-wrap:wrap;gap:.75rem 1.25rem;margin:0 0 .9rem}
.controls label{display:flex;flex-direction:column;font-size:.85rem;color:var(--soft);min-width:0}
select,input[type=search]{font:inherit;color:var(--ink);background:var(--card);border:1px solid #8794a3;
  border-radius:.35rem;padding:.25rem .5rem;max-width:100%}
.legend{display:flex;flex-wrap:wrap;gap:.3rem 1.1rem;border:0;padding:0;margin:0 0 .6rem;font-size:.95rem;
  min-width:0}
.legend label{display:inline-flex;align-items:center;gap:.4rem;cursor:pointer}
.legend svg{flex:none}
.legend .absent{opacity:.45}
.plot{position:relative;height:28rem;overflow:hidden}
.plot canvas:focus-visible{outline-offset:-3px}
.tools{display:flex;gap:.5rem;margin:.5rem 0 .75rem}
.tool{font:inherit;font-size:.8rem;color:var(--accent);background:none;border:1px solid var(--line);
  border-radius:.35rem;padding:.1rem .6rem;cursor:pointer}
.sort{all:unset;cursor:pointer;font:inherit;color:inherit}
.sort:focus-visible,.link:focus-visible{outline:3px solid var(--accent)}
th[aria-sort=ascending] .sort::after{content:" \2191"}
th[aria-sort=descending] .sort::after{content:" \2193"}
.link{border:0;background:none;color:inherit;padding:0;font:inherit;cursor:pointer;
  text-decoration:underline dotted;text-underline-offset:.2em}
.link.verdict{padding:0 .6rem}.link.good{background:var(--good);color:var(--good-ink)}
.link.bad{background:var(--bad);color:var(--bad-ink)}.link.plain{background:var(--plain);color:var(--plain-ink)}
.map{width:auto}
.map td{text-align:right;font-variant-numeric:tabular-nums;padding:0;border:1px solid var(--card)}
.map td button{all:unset;display:block;box-sizing:border-box;width:100%;padding:.3rem .5rem;cursor:pointer;
  text-align:right}
.map td button:focus-visible{outline:3px solid var(--accent);outline-offset:-3px}
.map thead th{vertical-align:bottom;white-space:normal}
.upright thead th+th{writing-mode:vertical-rl;transform:rotate(180deg);text-align:left;white-space:nowrap}
.s0{background:#f1f6fb;color:#16324a}.s1{background:#d7e7f4;color:#16324a}.s2{background:#a9cbe6;color:#0f2b43}
.s3{background:#6ba3d0;color:#06192a}.s4{background:#8a3300;color:#fff;font-weight:600}
.s5{background:#2f6ea5;color:#fff}
@media screen and (prefers-color-scheme:dark){.s0{background:#222d38;color:#dbe6f0}
  .s1{background:#21405a;color:#dbe6f0}.s2{background:#1f567f;color:#eef5fb}.s3{background:#2a74ab;color:#fff}
  .s4{background:#b04a10;color:#fff}.s5{background:#4f9fd8;color:#06192a}}
.chosen{outline:3px solid var(--accent);outline-offset:-3px}
@media (max-width:40rem){main{padding:1rem .75rem 2rem}.card{padding:.8rem .75rem}.plot{height:22rem}}
@media print{.tools,.controls,.legend input,.needs-script{display:none}.scroll{overflow:hidden}
  table{font-size:.62rem}.map{font-size:.55rem}th,td,.map td button{padding:.12rem .2rem;white-space:normal}
  main{max-width:none;padding:0}.plot{height:20rem}*{print-color-adjust:exact}}
)css";

std::string script_element(std::string_view text) {
  return "<script>" + std::string(text) + "</script>\n";
}

}  // namespace

std::string picture_html(std::string_view id, std::string_view caption) {
  return "<figure><div class=plot><canvas id=" + std::string(id) + " role=img></canvas></div>\n<figcaption>" +
         std::string(caption) + "</figcaption></figure>\n";
}

std::string report_page(const ReportPage& p, const Provenance& provenance) {
  return "<!DOCTYPE html>\n<html lang=en class=both>\n<head>\n<meta charset=utf-8>\n" +
         content_policy({chart_js_sha256, page_kit_js_sha256, p.script_sha256}) +
         "<meta name=viewport content=\"width=device-width, initial-scale=1\">\n<title>" + escape(p.title) +
         "</title>\n<link rel=icon href=\"data:,\">\n<style>" + std::string(page_style) +
         std::string(kit_style) + "</style>\n</head>\n<body>\n<main>\n<h1>" + escape(p.question) +
         "</h1>\n<p class=lead>" + p.lead + "</p>\n<p class=sum>" + escape(p.answer) +
         "</p>\n<noscript><p class=card>The pictures need JavaScript.</p></noscript>\n" + p.body +
         provenance_html(provenance) + "</main>\n<script type=\"application/json\" id=data>" +
         script_json(p.data) + "</script>\n" + script_element(chart_js) + script_element(page_kit_js) +
         script_element(p.script) + "</body>\n</html>\n";
}

}  // namespace darboux
