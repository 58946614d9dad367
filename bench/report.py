"""The results of suite.py as one HTML page that needs nothing but itself, with Debian's Chart.js."""
import json
import pathlib

CHART_JS = pathlib.Path("/usr/share/javascript/chart.js/chart.min.js")
COLOURS = ("#1f77b4", "#d62728", "#2ca02c", "#9467bd", "#ff7f0e", "#8c564b", "#17becf", "#7f7f7f")

STYLE = """body{font:16px/1.5 system-ui,sans-serif;max-width:1240px;margin:0 auto;padding:1rem;color:#222}
h1{font-size:1.6rem}h2{font-size:1.2rem;border-top:1px solid #ddd;padding-top:1rem}
.charts{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,380px),1fr));gap:1rem}
figure{margin:0;min-width:0}figcaption{font-weight:600;font-size:.9rem}.chart{position:relative;height:340px}
.table{overflow-x:auto}table{border-collapse:collapse;font-size:.9rem}
th,td{padding:.2rem .8rem .2rem 0;text-align:right;white-space:nowrap;border-bottom:1px solid #eee}
th:first-child,td:first-child{text-align:left}"""

SCRIPT = """const plain=v=>{const m=v/10**Math.floor(Math.log10(v)+1e-9);
  return [1,2,5].some(k=>Math.abs(m-k)<1e-6)?String(+v.toPrecision(3)):""};
charts.forEach((c,i)=>new Chart(document.getElementById("chart"+i),{type:"scatter",
  data:{datasets:c.series.map(s=>({label:s.name,data:s.points,borderColor:s.colour,backgroundColor:s.colour,
    borderDash:s.dashed?[6,4]:[],borderWidth:1.5,showLine:true,pointRadius:3}))},
  options:{animation:false,maintainAspectRatio:false,locale:"en-US",
    plugins:{legend:{position:"bottom",labels:{boxWidth:18,boxHeight:1,padding:10}}},
    scales:Object.fromEntries([["x",c.x],["y",c.y]].map(([axis,text])=>[axis,{type:"logarithmic",
      title:{display:true,text},ticks:{callback:plain,maxRotation:0}}]))}}));"""


def escaped(text):
    return str(text).replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")


def table(head, rows):
    def line(cells, tag):
        return "<tr>" + "".join(f"<{tag}>{escaped(cell)}</{tag}>" for cell in cells) + "</tr>"
    return f'<div class="table"><table>{line(head, "th")}{"".join(line(row, "td") for row in rows)}</table></div>'


def series_of(lines, key, y, dashed=lambda line: False):
    """One series per key, over the number of intervals; points without a value (None) are left out."""
    grouped = {}
    for line in lines:
        if y(line):
            grouped.setdefault(key(line), []).append(line)
    names = sorted({name for name, _ in grouped})
    return [{"name": " ".join(part for part in (name, kind) if part), "colour": COLOURS[names.index(name) % 8],
             "dashed": dashed(some[0]), "points": [{"x": line["intervals"], "y": y(line)} for line in some]}
            for (name, kind), some in grouped.items()]


def mesh_charts(lines):
    def key(line):
        return line["request"], line["linear_solver"]

    def is_reference(line):
        return line["linear_solver"] == "mumps"
    return [
        {"title": "An iteration of the optimiser", "x": "intervals", "y": "ms per iteration",
         "series": series_of(lines, key, lambda line: 1e3 * line["per_iteration"], is_reference)},
        {"title": "Its linear algebra", "x": "intervals", "y": "us per iteration and interval",
         "series": series_of(lines, key, lambda line: 1e6 * line["linear_algebra_per_iteration"] / line["intervals"],
                             is_reference)},
    ]


def published_chart(lines):
    return {"title": "Published optima", "x": "intervals", "y": "relative difference from the published value",
            "series": series_of(lines, lambda line: (line["problem"], ""),
                                lambda line: abs(line["value"] / line["reference"] - 1))}


def motion_rows(motions):
    for name, motion in motions.items():
        for mode in ("cold", "warm", "mumps"):
            if mode in motion:
                s = motion[mode]
                yield [name, mode, f"{s['certified']}/{s['runs']}", f"{s['iterations']:g}", s["factorisations"] or "-",
                       f"{s['intervals']:g}", f"{s['cpu']:.3f}", f"{s['cpu_min']:.3f}", f"{s['cpu_max']:.3f}",
                       f"{s['timing']['cpu']:.3f}", f"{s['memory']:.0f}",
                       *(f"{100 * share:.0f}" for share in s["shares"].values())]


def page(results):
    charts = [*mesh_charts(results["mesh"]), published_chart(results["published"])]
    figures = "".join(f'<figure><figcaption>{escaped(c["title"])}</figcaption>'
                      f'<div class="chart"><canvas id="chart{i}"></canvas></div></figure>'
                      for i, c in enumerate(charts))
    layers = [[f"{program} {name}", *(f"{1e6 * times[key]:.3f}" for key in ("median", "min", "max"))]
              for program, benchmarks in results["layers"].items() for name, times in benchmarks.items()]
    data = json.dumps(charts).replace("<", "\\u003c")
    return "".join((
        f'<!doctype html><html lang="en"><meta charset="utf-8"><meta name="viewport" content="width=device-width">'
        f"<title>Benchmarks</title><style>{STYLE}</style><h1>Benchmarks</h1>",
        f'<p>bench/README.md says what each figure means.</p><div class="charts">{figures}</div>',
        "<h2>Motions</h2>",
        table(["motion", "mode", "certified", "iterations", "factorisations", "intervals", "CPU s", "min", "max",
               "plan s", "MiB", "evaluation %", "linear algebra %", "Ipopt %", "certificate %"],
              motion_rows(results["motions"])),
        "<h2>Published problems</h2>",
        table(["problem", "source", "intervals", "here", "published", "digits", "iterations", "ms"],
              [[p["problem"], p["source"], p["intervals"], f"{p['value']:.10f}", f"{p['reference']:.9g}",
                f"{p['digits']:.1f}", p["iterations"], f"{1e3 * p['seconds']:.1f}"] for p in results["published"]]),
        "<h2>Layers</h2>", table(["us", "median", "min", "max"], layers),
        f"<script>{CHART_JS.read_text()}</script><script>const charts={data};{SCRIPT}</script></html>\n"))
