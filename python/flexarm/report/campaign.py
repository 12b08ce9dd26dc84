"""The page of a campaign: distributions, bands, Sobol indices, yield, and trends of a fleet.

One HTML file with its figures in it, from findings that are given as data.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from flexarm.report.files import drawn, filled, legend_below, margin_for, sheet
from flexarm.wording import labelled_scale, number, scale, with_unit

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from flexarm.campaigns.findings import Band, Cost, Findings, Target
    from flexarm.campaigns.trends import Trend

BLUE, ORANGE, GREY = "#0072b2", "#e69f00", "#777777"
"""Of Okabe and Ito's colours, told apart by everyone."""


def page(findings: Findings, record: Mapping[str, Any]) -> str:
    """Return the page of findings as HTML; `record` is what study.json holds."""
    failed = f"of which {findings.failed}" if findings.failed else "none of which"
    return filled(
        "campaign.html.j2",
        f=findings,
        record=record,
        headline=[f"{findings.count} runs, {failed} failed.", *sentences(findings)],
        targets=[_target_row(each) for each in findings.targets],
        has_nominal=any(each.nominal is not None for each in findings.targets),
        indices=[_index_rows(findings, each) for each in findings.targets if each.indices is not None],
        total=_has_total(findings.targets),
        costs=[_cost_rows(findings, each) for each in findings.costs],
        change=_change,
        drawn=drawn(_figures(findings)),
    )


def sentences(f: Findings) -> Iterator[str]:
    """Yield what a campaign found, the yield first."""
    for each in f.yields:
        share, low, high = (f"{100 * part:.1f} %" for part in (each.share, each.low90, each.high90))
        tolerance = with_unit(each.tolerance, each.unit)
        yield f"In {share} of the runs ({low} to {high}) {each.name} is within {tolerance}."
    for cost in f.costs:
        k = int(np.argmax(cost.first))
        alone, whole = (with_unit(size, cost.unit) for size in (float(cost.each[k]), cost.rms))
        yield f"{f.parameters[k][0]} costs most: {alone} rms of {cost.name} alone, of {whole} in all."
    for target in f.targets[: 0 if f.costs else 3]:
        if target.indices is not None:
            k = int(np.argmax(target.indices.first))
            part = 100 * max(0.0, float(target.indices.first[k]))
            yield f"{f.parameters[k][0]} alone explains {part:.0f} % of the variance of {target.name}."
    if f.trends and abs(f.trends[0].score) >= 2:  # standard errors
        surest = f.trends[0]
        way = "grows" if surest.slope * (surest.mean or 1) > 0 else "shrinks"
        yield f"{surest.name} {way} by {_change(surest, f.time)}: the surest trend."
    elif f.time:
        yield "No value that the diagnoses found changes by more than chance."


def spreads(f: Findings) -> Iterator[str]:
    """Yield median and 90 % range of every number of the runs."""
    for target in f.targets:
        factor, unit = scale(target.quantiles, target.unit)
        low, median, high = (number(factor * each, 4) for each in target.quantiles[[0, 2, 4]])
        yield f"{target.name}: median {median}, 90 % of the runs from {low} to {high} {unit}".rstrip()


def _change(each: Trend, time: str) -> str:
    factor, unit = scale([each.slope, each.std], each.unit)
    per = f"{unit} a {time}" if time == "year" else f"{unit} per {time}"
    return f"{number(abs(factor * each.slope))} ± {number(factor * each.std, 2)} {per}"


def _target_row(target: Target) -> dict[str, Any]:
    sizes = [*target.quantiles, 0.0 if target.nominal is None else target.nominal]
    factor, unit = scale(sizes, target.unit)
    mean, std = float(target.values.mean()), float(target.values.std())
    return {
        "name": target.name,
        "unit": unit or "–",
        "nominal": "–" if target.nominal is None else number(factor * target.nominal, 4),
        "numbers": [number(factor * each, 4) for each in (mean, std, *target.quantiles[[0, 2, 4]])],
    }


def _cost_rows(f: Findings, cost: Cost) -> dict[str, Any]:
    """Return what each parameter costs as texts, the greatest first."""
    factor, unit = labelled_scale([cost.rms], cost.unit)
    least = number(factor * cost.rms * cost.chance**0.5, 2)
    rows = [
        (f.parameters[k][0], number(factor * float(cost.each[k])), f"{100 * cost.first[k]:.1f} %")
        if cost.first[k] > cost.chance
        else (f.parameters[k][0], f"below {least}", f"below {100 * cost.chance:.1f} %")
        for k in np.argsort(-cost.first)
    ]
    rest = max(0.0, 1 - float(np.maximum(cost.first, 0).sum()))
    rows.append(("interactions and chance", number(factor * cost.rms * rest**0.5), f"{100 * rest:.0f} %"))
    return {
        "name": cost.name,
        "unit": unit,
        "rows": [*rows, ("all", number(factor * cost.rms), "100 %")],
    }


def _index_rows(f: Findings, target: Target) -> dict[str, Any]:
    """Return the indices of a target as texts, the greatest first."""
    found = target.indices
    assert found is not None
    order = np.argsort(-np.nan_to_num(np.where(np.isfinite(found.total), found.total, found.first)))
    rows = [
        (
            f.parameters[k][0],
            f"{found.first[k]:.2f}",
            f"{found.first90[k, 0]:.2f} to {found.first90[k, 1]:.2f}",
            f"{found.total[k]:.2f}" if np.isfinite(found.total[k]) else "",
            f"{found.total90[k, 0]:.2f} to {found.total90[k, 1]:.2f}" if np.isfinite(found.total[k]) else "",
        )
        for k in order
    ]
    return {"name": target.name, "rows": rows, "sum": f"{found.first.sum():.2f}"}


def _figures(f: Findings) -> Iterator[tuple[str, str, str, Figure | None]]:
    if f.targets:
        nominal = any(each.nominal is not None for each in f.targets[:9])
        caption = (
            f"Distribution over the runs; lines: 5, 50 and 95 %{'; dashed: nominal run' if nominal else ''}."
        )
        yield "distributions", "distributions", caption, _histograms(f.targets[:9])
    with_indices = [each for each in f.targets if each.indices is not None]
    if with_indices:
        caption = (
            "Sobol indices with 90 % intervals: part of the variance that a parameter explains alone (blue)"
        )
        caption += ", and with all its interactions (orange)." if _has_total(with_indices) else "."
        yield "indices", "indices", caption, _index_bars(f, with_indices[:6])
    if f.bands:
        caption = "Deviation from the nominal run: median, and bands that hold 50 and 90 % of the runs."
        yield "bands", "bands", caption, _bands(f.bands[:9])
    if f.trends:
        caption = "What the diagnoses found, by machine, and the pooled trend (black)."
        yield "trends", "trends", caption, _trends(f.trends[:3], f.time)


def _histograms(targets: Sequence[Target]) -> Figure:
    columns = min(3, len(targets))
    rows = -(-len(targets) // columns)
    figure, axes = sheet(rows, columns, 1.3, between=(0.5, 0.75), legend=False)
    for ax, each in zip(axes.flat, targets, strict=False):
        factor, unit = labelled_scale(each.quantiles, each.unit)
        ax.hist(factor * each.values, bins=min(40, max(8, len(each.values) // 20)), color=BLUE, alpha=0.6)
        for at in each.quantiles[[0, 2, 4]]:
            ax.axvline(factor * at, color="black", lw=0.8)
        if each.nominal is not None:
            ax.axvline(factor * each.nominal, color="black", lw=0.8, ls="--")
        ax.set_title(each.name)
        short = each.name.split("_")[-1] if len(each.name) > 18 else each.name  # a narrow axis holds a word
        ax.set_xlabel(f"{short} [{unit}]")
    for ax in axes[:, 0]:
        ax.set_ylabel("runs")
    for ax in list(axes.flat)[len(targets) :]:
        ax.set_visible(False)
    return figure


def _has_total(targets: Sequence[Target]) -> bool:
    return any(each.indices is not None and bool(np.isfinite(each.indices.total).any()) for each in targets)


def _index_bars(f: Findings, targets: Sequence[Target]) -> Figure:
    keys = [key for key, _ in f.parameters]
    height = 0.2 * len(keys) + 0.25
    figure, axes = sheet(
        len(targets),
        1,
        height,
        left=margin_for(keys, 8),
        between=(0.0, 0.35),
        legend=_has_total(targets),
        sharex=True,
    )
    y = np.arange(len(keys))
    for ax, each in zip(axes[:, 0], targets, strict=True):
        found = each.indices
        assert found is not None
        half = (found.first90[:, 1] - found.first90[:, 0]) / 2
        beside = 0.2 if np.isfinite(found.total).any() else 0.0  # a bar alone sits at its name
        ax.barh(y + beside, found.first, 0.38, xerr=half, color=BLUE, ecolor=GREY, label="first order")
        if beside:
            half = (found.total90[:, 1] - found.total90[:, 0]) / 2
            ax.barh(y - beside, found.total, 0.38, xerr=half, color=ORANGE, ecolor=GREY, label="total")
        ax.set_yticks(y, keys, fontsize=8)
        ax.set_title(each.name)
        ax.invert_yaxis()
    axes[-1, 0].set_xlabel("part of the variance [-]")
    axes[-1, 0].set_xlim(-0.05, 1.05)
    if _has_total(targets):
        legend_below(figure, axes[0, 0])
    return figure


def _bands(bands: Sequence[Band]) -> Figure:
    figure, axes = sheet(
        len(bands), 1, 1.15, between=(0.0, 0.45), sharex=len({len(b.time) for b in bands}) == 1
    )
    for ax, each in zip(axes[:, 0], bands, strict=True):
        factor, unit = labelled_scale(each.quantiles.ravel(), each.unit)
        low, quarter, median, upper, high = factor * each.quantiles
        ax.fill_between(each.time, low, high, color=BLUE, alpha=0.2, lw=0, label="90 % of the runs")
        ax.fill_between(each.time, quarter, upper, color=BLUE, alpha=0.4, lw=0, label="50 %")
        ax.plot(each.time, median, color=BLUE, label="median")
        ax.axhline(0.0, color="black", lw=0.8, ls="--", label="nominal run")
        ax.set_title(each.name)
        ax.set_ylabel(f"deviation [{unit}]")
    axes[-1, 0].set_xlabel("time [s]")
    legend_below(figure, axes[0, 0])
    return figure


def _trends(trends: Sequence[Trend], time: str) -> Figure:
    figure, axes = sheet(len(trends), 1, 1.5, between=(0.0, 0.45), legend=False, sharex=True)
    for ax, each in zip(axes[:, 0], trends, strict=True):
        factor, unit = labelled_scale(each.value, each.unit)
        groups = list(dict.fromkeys(each.group))
        for name in groups[:10]:
            rows = np.array([group == name for group in each.group])
            order = np.argsort(each.time[rows])
            ax.plot(each.time[rows][order], factor * each.value[rows][order], "o-", ms=3, lw=0.8, alpha=0.7)
        t = np.array([each.time.min(), each.time.max()])
        line = each.mean + each.slope * (t - each.time.mean())
        ax.plot(t, factor * line, color="black", lw=1.6)
        ax.set_title(each.name)
        ax.set_ylabel(f"value [{unit}]")
    axes[-1, 0].set_xlabel(
        "time since the first date [year]" if time == "year" else f"{time} since the first"
    )
    return figure
