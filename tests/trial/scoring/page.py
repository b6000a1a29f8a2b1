"""The trial's result as one self-contained page: the table, what every stratum gave, what the trial holds and lacks."""

import html

from trial.scoring import score

STYLE = """
body { font: 15px/1.45 system-ui, sans-serif; margin: 2rem auto; max-width: 72rem; color: #1c1c1e; padding: 0 1rem }
table { border-collapse: collapse; margin: 1rem 0; font-variant-numeric: tabular-nums }
td, th { padding: .25rem .6rem; border-bottom: 1px solid #ddd; text-align: right; white-space: nowrap }
td:first-child, th:first-child { text-align: left } .met { color: #13693b } .short { color: #a3161e; font-weight: 600 }
.bar { background: #e6e6ea; width: 9rem; height: .7rem; position: relative } .bar i { background: #7d8fb3; position:
absolute; top: 0; bottom: 0 } .bar b { background: #14284b; position: absolute; top: -2px; bottom: -2px; width: 2px }
"""

HOLDS = (
    "Forces of an axisymmetric finite-element pad over bone (finite strain, of its own mesh and code, checked against "
    "felupe), flat as the base model has it, in eight sizes: two for calibration, three for each trial; three spheres, "
    "three speeds, a hold, four cycles. Pads, tools, speeds and seeds of calibration and both trials are disjoint.",
    "Nine of the twelve tissue effects, six pairs, seven instrument errors, four mixtures; what no list holds: a "
    "pulse, muscle tone, a blister. Spots: mat pressures of a curved pad with and without a stiff or soft ball, from "
    "three-dimensional elements; there all trial spots lie in one shape of pad, at two pitches of the mat.",
    "Two effects, or an effect and an error of the instrument: each alone as severe as planned, or as it can be. A "
    "grip has eleven strengths, each computed, since where it lets go depends on its strength.",
    "Noise of 1 or 3 % of a recording's largest force, coloured (0.15 s); for a part of the nulls with outliers, four "
    "times slower, or with twice the scatter between repeats; 4 % of gain and 0.02 mm of first touch from press to "
    "press.",
)
LACKS = (
    "Friction, coupling across creases, crosstalk and misregistration as things to be named, fibres, skin that slides, "
    "scans, and the 2 mm punch: no case has them, so nothing is proved of them.",
    "The severity is what remains over the noise after G0 and Glim are refitted to all recordings together; in any "
    "single curve less remains. It is of the effect alone, before scatter between repeats is added, which hides "
    "more: a case of severity 1 may be below what any test can see.",
    "In the second trial a case counts as what its recordings hold, weighed before any diagnosis saw them by an oracle "
    "that knows every form and the noise (make_second.py): one name if it gives it in nine of ten draws, ambiguous if "
    "it sees the effect and can hardly ever tell it from its closest rival; what is left over is `beyond` and asked "
    "for nothing, except that nothing wrong is named. That leaves few bones and no compressibility to be named. What "
    "follows is of the first trial.",
    "A case of one effect counts as ambiguous if some other single effect, fitted in its place with its own finite "
    "elements, leaves less than 0.3 of the noise; only the closest is in the label. A verdict that tells of three that "
    "cannot be told apart is right only if that pair is told too. Between 0.3 and about 0.5 an effect is listed as "
    "one to be named although little separates it from its rival.",
    "Pairs, mixtures and instrument errors are not checked for rivals, and the 4 % of gain from press to press hides "
    "what only scales a tool or a half of the session: `python -m trial.scoring.ceiling` (in tests) says how much an "
    "oracle could name that knows every form and the noise. Of single effects with a severity of 1 or more that is "
    "about four of five: most bones, half of the stiff skins and any compressibility are below what these recordings "
    "show.",
    "There is one salt for all labels: cases with maps whose labels are alike have the same hash, so the index tells "
    "which these are. The diagnosis reads study folders and never the index. What locating allows for was set on nulls "
    "of the same six shapes of pad, with other seeds, moduli and mountings.",
    "Real skin is no pad of elements: the truth's base is one that the base model can hold to 1 %.",
)


def page(split, tables, strata, faults):
    """HTML; `tables`: rows by diagnosis, the first one the one on trial; `strata`: lines of `by_stratum`."""
    first, *others = tables
    parts = [
        f"<h1>The blind trial: {html.escape(first)}, {html.escape(split)}</h1>",
        "<p>Bars are 95 % bounds (Wilson's for shares). The baselines were asked about curves only, not about mats. "
        "The oracle knows every cause's form and the noise, and only weighs (ceiling.py).</p>",
        _table(tables[first], {name: {row.key: row for row in tables[name]} for name in others}),
        "<h2>By kind and severity</h2>",
        _strata(strata),
        "<h2>What the trial holds</h2>" + _list(HOLDS),
        "<h2>What it does not, and how to read it</h2>" + _list(LACKS),
        "<h2>Wrong endings</h2>" + _faults(faults),
    ]
    head = f'<!doctype html><meta charset="utf-8"><title>The blind trial</title><style>{STYLE}</style>'
    return head + "\n".join(parts) + "\n"


def _table(found, beside):
    others = "".join(f"<th>{html.escape(name)}</th>" for name in beside)
    head = f"<tr><th></th><th>value</th><th>95 %</th><th></th><th>of</th><th>must</th><th>goal</th>{others}</tr>"
    lines = []
    for row in found:
        cells = [score.number(row), score.interval(row), _bar(row), row.of]
        cells += [_aim(row, row.must, row.holds()), _aim(row, row.goal, row.reaches())]
        cells += [score.number(other.get(row.key)) for other in beside.values()]
        name = html.escape(row.name).replace("  ", "&emsp;")
        lines.append(f"<tr><td>{name}</td>" + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>")
    return f"<table>{head}{''.join(lines)}</table>"


def _bar(row):
    """The bounds of a share."""
    if row.hits is None or not row.of:
        return ""
    low, high = (100.0 * bound for bound in row.bounds)
    inner = f'<i style="left:{low:.1f}%;width:{high - low:.1f}%"></i><b style="left:{100.0 * row.value:.1f}%"></b>'
    return f'<div class="bar">{inner}</div>'


def _aim(row, aim, is_met):
    if aim is None:
        return ""
    kind = {True: "met", False: "short", None: ""}[is_met]
    return f'<span class="{kind}">{"&le;" if row.is_ceiling else "&ge;"} {aim:.2f} {score.MARKS[is_met]}</span>'


def _strata(lines):
    head = "<tr><th>kind</th><th>what</th><th>severity</th><th>right</th><th>of</th></tr>"
    rows = (
        f"<tr><td>{html.escape(stratum)}</td><td>{html.escape(kind)}</td><td>{kappa:.1f}</td><td>{hits}</td>"
        f"<td>{of}</td></tr>"
        for stratum, kind, kappa, hits, of in lines
    )
    return f"<table>{head}{''.join(rows)}</table>"


def _list(texts):
    return "<ul>" + "".join(f"<li>{html.escape(text)}</li>" for text in texts) + "</ul>"


def _faults(faults):
    told = [f"{name}: {sentence}" for name, sentences in faults.items() for sentence in sentences]
    return _list(told) if told else "<p>None: every case ended well and wrote what it must.</p>"
