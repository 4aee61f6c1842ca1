"""The oracle of synthesis: brute force, which every search must agree with on every block."""

from processing.ptm.synthesis.settings import SearchKind
from tests.processing.ptm.synthesis.picks import CASES, agreement

SEEDS = 20
SEARCHES: tuple[SearchKind, ...] = ("fft", "svd", "dct", "haar", "walsh")
EVERY_KIND = 2
"""For so many seeds all kinds of kernels are asked; for the others the two searches that users choose from most."""


def picks() -> str:
    """Count the blocks of which a search chose another than brute force, over all seeds, as a Markdown table."""
    lines = [f"| source, join | blocks | {' | '.join(SEARCHES)} |", f"| --- | --- |{' --- |' * len(SEARCHES)}"]
    for case in CASES:
        blocks, asked, different = 0, dict.fromkeys(SEARCHES, 0), dict.fromkeys(SEARCHES, 0)
        for seed in range(SEEDS):
            found = agreement(case, SEARCHES if seed < EVERY_KIND else SEARCHES[:2], seed)
            blocks += found["fft"].blocks
            for search, one in found.items():
                asked[search] += one.blocks
                different[search] += one.different
        cells = " | ".join(f"{different[search]} of {asked[search]}" for search in SEARCHES)
        lines.append(f"| {case} | {blocks} | {cells} |")
    return "\n".join(lines)
