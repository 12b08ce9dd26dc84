"""`python -m torture`, in the folder tests: runs campaigns, shows one case, writes the table."""

from __future__ import annotations

import argparse
import collections
import re
import sys
from pathlib import Path

from torture import campaign as campaigns
from torture.campaigns import CAMPAIGNS
from torture.outcome import FAILED
from torture.sandbox import preload
from torture.table import write


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m torture", description=__doc__)
    parser.add_argument(
        "campaign", nargs="*", metavar="CAMPAIGN", help=f"of {', '.join(CAMPAIGNS)}; default all"
    )
    parser.add_argument("--seed", type=int, default=1, help="of all cases")
    parser.add_argument(
        "--only", type=int, metavar="N", help="run case N of one campaign and show what it does"
    )
    parser.add_argument("--scale", type=float, default=1.0, help="share of the cases of a long run")
    parser.add_argument("--sample", action="store_true", help="run the few cases of make test")
    parser.add_argument("--jobs", type=int, default=1, help="workers")
    parser.add_argument(
        "--out", type=Path, default=campaigns.ROOT / "build" / "torture", help="record of runs"
    )
    parser.add_argument("--table", type=Path, metavar="PAGE", help="write the counts into PAGE")
    given = parser.parse_args()
    given.out = given.out.resolve()
    if unknown := set(given.campaign) - set(CAMPAIGNS):
        parser.error(f"there is no campaign {', '.join(unknown)}; there are {', '.join(CAMPAIGNS)}")
    chosen = [CAMPAIGNS[name] for name in given.campaign or CAMPAIGNS]
    if given.only is not None:
        return show(chosen[0], given.only, given.seed, given.out)
    failed = 0
    for campaign in chosen:
        count = campaign.sample if given.sample else max(1, round(given.scale * campaign.cases))
        lines = campaigns.run(campaign, range(count), given.seed, given.jobs, given.out)
        failed += report(campaign, lines, given.seed)
    if given.table is not None:
        write(given.table, given.out, given.seed)
    return 1 if failed else 0


def report(campaign: campaigns.Campaign, lines: list[dict], seed: int) -> int:
    """Prints counts, and failures that tell the same once; returns the number of failures."""
    counts = collections.Counter(line["kind"] for line in lines)
    seconds = sum(line["cpu"] for line in lines)
    told = ", ".join(f"{count} {kind}" for kind, count in counts.most_common())
    print(f"{campaign.name}: {len(lines)} cases in {seconds:.0f} s of CPU: {told}", flush=True)
    alike = collections.defaultdict(list)
    for line in lines:
        if line["kind"] in FAILED:
            tool = " ".join(line["step"].split()[:2])
            alike[line["kind"], tool, re.sub(r"[\d.]+|'[^']*'", "_", line["detail"])[:30]].append(line)
    for (kind, _, _), group in sorted(alike.items(), key=lambda item: -len(item[1])):
        line = min(group, key=lambda line: len(line["case"]))
        print(
            f"  {len(group)} x {kind}: {line['step'][:100]}: {line['detail']}\n      such as {line['case']}"
        )
        print(f"      python -m torture {campaign.name} --seed {seed} --only {line['number']}", flush=True)
    return sum(counts[kind] for kind in FAILED)


def show(campaign: campaigns.Campaign, number: int, seed: int, out: Path) -> int:
    """Runs one case, with its files, texts and outcome on standard output."""
    preload(campaigns.seeds(out))
    line = campaigns.outcomes(campaign, number, seed, out, show=True)
    print(f"\ncase     {line['case']}\nstep     {line['step']}\noutcome  {line['kind']}: {line['detail']}")
    print(f"files    {out / 'work' / f'{campaign.name}-{seed}-{number}'}\nfigures  {line['values']}")
    return 1 if line["kind"] in FAILED else 0


if __name__ == "__main__":
    sys.exit(main())
