"""What is on each sheet: the MatCap paper's figures of the same numbers, with balls and meshes of our own."""

from pathlib import Path

import numpy as np
import paint
import shapes
from numpy.typing import NDArray
from PIL import Image
from sheet import Cell
from workshop import Workshop, recipe

from processing.matcap.matcap_exr import read_matcap

F64 = NDArray[np.float64]
Rows = list[list[Cell]]


def figure_01(shop: Workshop) -> Rows:
    """Return decomposition, turned light, colours, roughness."""
    clay = shop.matcap("clay")
    turned = shop.edited("01-c.matcap.exr", clay, *recipe("top-left"))
    coloured = shop.edited("01-d.matcap.exr", turned, *recipe("figure-01-colours"))
    rougher = shop.edited("01-e.matcap.exr", turned, *recipe("figure-01-rougher"))
    return [
        [
            Cell("(a) a MatCap on a mask", shop.rendered("01-a", clay, "mask"), inset=shop.source("clay")),
            Cell("(b) low (above) and high", _maps(clay)),
            Cell("(c) light from the upper left", shop.rendered("01-c", turned, "mask")),
            Cell("(d) other colours", shop.rendered("01-d", coloured, "mask")),
            Cell("(e) rougher", shop.rendered("01-e", rougher, "mask")),
        ]
    ]


def figure_06(shop: Workshop) -> Rows:
    """Return the steps of decomposition."""
    rows = []
    for name in ("jade", "steel", "dark"):
        low, high = shop.layers(name)
        matcap = shop.matcap(name)
        white = ("--colour", "1", "1", "1")
        low_white = shop.edited(f"06-{name}-low.png", matcap, *white, "--gain", "1", "0")
        high_white = shop.edited(f"06-{name}-high.png", matcap, *white, "--gain", "0", "1")
        rows.append(
            [
                Cell("(a) input", shop.source(name), ball=True),
                Cell("(b) low frequencies", low, ball=True),
                Cell("(b) high frequencies", high, ball=True),
                Cell("(c) low, in white light", low_white, ball=True),
                Cell("(c) high, in white light", high_white, ball=True),
                Cell("(d) low (above) and high", _maps(matcap)),
            ]
        )
    return rows


def figure_10(shop: Workshop) -> Rows:
    """Return painted lights and a hung picture, turned."""
    amber, dark = shop.matcap("amber"), shop.matcap("dark")
    _save(shop.folder / "flame.png", paint.flame())
    painted = shop.edited("10-b.matcap.exr", amber, *recipe("figure-10-painted"))
    flaming = shop.edited("10-e.matcap.exr", dark, *_local_recipe(shop, "figure-10-flame"))
    turned = shop.edited("10-c.matcap.exr", painted, "--rotate", "y", "55")
    around = shop.edited("10-f.matcap.exr", flaming, "--rotate", "y", "-50")
    pairs = [
        [("(a) one reflection", amber), ("(b) two more are painted", painted), ("(c) turned to the right", turned)],
        [("(d) a dark, glossy place", dark), ("(e) a flame hung into it", flaming), ("(f) turned to the left", around)],
    ]
    return [[_both(shop, f"10-{label[1]}", label, matcap, "mask") for label, matcap in row] for row in pairs]


def figure_11(shop: Workshop) -> Rows:
    """Return rougher and shinier, another colour, a silhouette."""
    lacquer, jade = shop.matcap("lacquer"), shop.matcap("jade")
    steps = [
        [("(a) glossy", lacquer, ""), ("(b) rougher", lacquer, "rougher"), ("(c) shinier", lacquer, "shinier")],
        [
            ("(d) greenish", jade, ""),
            ("(e) reddish, in contrast", jade, "red"),
            ("(f) a silhouette", jade, "silhouette"),
        ],
    ]
    rows = []
    for row in steps:
        cells = []
        for label, matcap, name in row:
            key = f"11-{label[1]}"
            changed = shop.edited(f"{key}.matcap.exr", matcap, *recipe(f"figure-11-{name}")) if name else matcap
            cells.append(_both(shop, key, label, changed, "mask"))
        rows.append(cells)
    return rows


def figure_13(shop: Workshop) -> Rows:
    """Return low frequencies of one with high ones of the other."""
    gold, cobalt = shop.matcap("gold"), shop.matcap("porcelain")
    first = shop.edited("13-c.matcap.exr", gold, "--take-high", cobalt)
    second = shop.edited("13-d.matcap.exr", cobalt, "--take-high", gold)
    labels = ("(a) gold", "(b) porcelain", "(c) low of (a), high of (b)", "(d) low of (b), high of (a)")
    four = zip(labels, (gold, cobalt, first, second), strict=True)
    return [[_both(shop, f"13-{label[1]}", label, matcap, "mask") for label, matcap in four]]


def figure_14(shop: Workshop) -> Rows:
    """Return three MatCaps on one mesh."""
    robot = shapes.robot()
    ids = _save(shop.folder / "robot-ids.png", paint.material_ids(robot))
    names = ("lacquer", "steel", "gold")
    each = [shop.matcap(name) for name in names]
    lead = each[-1]
    turned = zip(names[:-1], each[:-1], strict=True)
    aligned = [*(shop.edited(f"14-c-{name}.matcap.exr", matcap, "--align", lead) for name, matcap in turned), lead]
    changes = (("--roughness", "14", "--hue", "215"), ("--roughness", "12"), ("--roughness", "3", "--gain", "1", "1.5"))
    changed = [
        shop.edited(f"14-d-{name}.matcap.exr", matcap, *change)
        for name, matcap, change in zip(names, aligned, changes, strict=True)
    ]

    def three(key: str, matcaps: list[Path], *options: str) -> Path:
        others = [word for matcap in matcaps[1:] for word in ("--with", matcap)]
        return shop.rendered(key, matcaps[0], "robot", "--material-ids", ids, *others, *options)

    # The high frequencies of a matt ball are no more than grain.
    matt = shop.edited("14-a.matcap.exr", shop.matcap("plaster"), "--gain", "1", "0")
    flat = shop.rendered("14-a", matt, "robot", "--low-texture", ids)
    return [
        [
            Cell("(a) material IDs", flat),
            Cell("(b) three MatCaps", three("14-b", each)),
            Cell("(c) highlights aligned", three("14-c", aligned)),
            Cell("(d) other materials", three("14-d", changed)),
            Cell("(e) turned together", three("14-e", changed, "--light", "0.7", "-0.1")),
        ]
    ]


def figure_15(shop: Workshop) -> Rows:
    """Return textures on either half, and of roughness."""
    parts = shapes.cow()
    colours = _save(shop.folder / "cow-colours.png", shapes.painted(parts, paint.cow_patches, 192, 256))
    rough = _save(shop.folder / "cow-rough.png", shapes.painted(parts, paint.cow_rough, 192, 256))
    matcap = shop.matcap("porcelain")
    behind = shop.edited("15-e.matcap.exr", matcap, "--rotate", "y", "-130")
    low = ("--low-texture", colours)
    both = (*low, "--high-texture", colours)
    varied = (*both, "--roughness-texture", rough, "--roughest", "0", "24")
    return [
        [
            Cell(
                "(a) porcelain on a toy",
                shop.rendered("15-a", matcap, "cow"),
                inset=shop.source("porcelain"),
                on_right=True,
            ),
            Cell("(b) low frequencies coloured", shop.rendered("15-b", matcap, "cow", *low)),
            Cell("(c) high ones too", shop.rendered("15-c", matcap, "cow", *both)),
            Cell("(d) rough but for the patches", shop.rendered("15-d", matcap, "cow", *varied)),
            Cell("(e) light from behind", shop.rendered("15-e", behind, "cow", *varied)),
        ]
    ]


def figure_16(shop: Workshop) -> Rows:
    """Return occlusion, a texture and silhouettes, one after the other."""
    parts = shapes.mask()
    colours = _save(shop.folder / "mask-colours.png", shapes.painted(parts, paint.face_paint, 384, 384))
    pale = shop.edited("16-a.matcap.exr", shop.matcap("amber"), "--saturation", "0.15", "--value", "1.3")
    outlined = shop.edited("16-d.matcap.exr", pale, *recipe("figure-16-silhouettes"))
    below = shop.edited("16-e.matcap.exr", outlined, "--rotate", "x", "75")
    dark = ("--occlusion",)
    coloured = (*dark, "--low-texture", colours)
    return [
        [
            Cell("(a) paler than in 10 (a)", shop.rendered("16-a", pale, "mask")),
            Cell("(b) with occlusion", shop.rendered("16-b", pale, "mask", *dark)),
            Cell("(c) low frequencies coloured", shop.rendered("16-c", pale, "mask", *coloured)),
            Cell("(d) silhouettes", shop.rendered("16-d", outlined, "mask", *coloured)),
            Cell("(e) light from below", shop.rendered("16-e", below, "mask", *coloured)),
        ]
    ]


FIGURES = {
    "01": figure_01,
    "06": figure_06,
    "10": figure_10,
    "11": figure_11,
    "13": figure_13,
    "14": figure_14,
    "15": figure_15,
    "16": figure_16,
}


def _both(shop: Workshop, key: str, label: str, matcap: Path, mesh: str) -> Cell:
    ball = shop.edited(f"{key}-ball.png", matcap)
    return Cell(label, shop.rendered(key, matcap, mesh), inset=ball)


def _local_recipe(shop: Workshop, name: str) -> tuple[str, Path]:
    """Put a recipe that hangs a picture beside that picture: it names files as seen from its folder."""
    words, file = recipe(name)
    local = shop.folder / file.name
    local.write_text(file.read_text())
    return words, local


def _maps(matcap: Path, side: int = 220) -> Image.Image:
    """Return front and back of the low frequencies, and of the high ones below: discs of half of all directions."""
    read = read_matcap(matcap)
    sheet = Image.new("RGB", (2 * side, 2 * side), "#f4f3f0")
    rows, columns = np.mgrid[: 8 * side, : 8 * side]
    inside = np.hypot(rows - 4 * side + 0.5, columns - 4 * side + 0.5) < 4 * side - 16
    mask = Image.fromarray((inside * 255).astype(np.uint8)).resize((side, side), Image.Resampling.LANCZOS)
    for down, half in enumerate((read.low, read.high)):
        for right, picture in enumerate((half.front, half.back)):
            shown = Image.fromarray(np.round(_srgb(picture) * 255).astype(np.uint8))
            shown = shown.resize((side, side), Image.Resampling.LANCZOS)
            sheet.paste(shown, (right * side, down * side), mask)
    return sheet


def _srgb(linear: NDArray[np.float32]) -> F64:
    value = np.clip(linear.astype(np.float64), 0, 1)
    return np.where(value <= 0.0031308, 12.92 * value, 1.055 * value ** (1 / 2.4) - 0.055)


def _save(path: Path, display: F64) -> Path:
    Image.fromarray(np.round(np.clip(display, 0, 1) * 255).astype(np.uint8)).save(path)
    return path
