from pathlib import Path

import numpy as np
import pytest

from processing.ptm.basis import PTM, Basis
from processing.ptm.files.ptm_file import ptm_coder
from processing.ptm.fit import FitSettings, start_fit
from processing.ptm.model import Colour
from processing.ptm.quality import report_on
from processing.ptm.robust import Robust
from processing.stack import Stack
from tests.processing.ptm.relief import dome, relief_pictures, write_relief

LIGHTS = dome(14)


@pytest.fixture(scope="module")
def relief(tmp_path_factory: pytest.TempPathFactory) -> Stack:
    return Stack(write_relief(tmp_path_factory.mktemp("relief"), LIGHTS, 32))


@pytest.mark.parametrize("basis", [PTM, Basis("ptm", 3), Basis("hsh", 4)], ids=str)
def test_leaving_out_is_what_a_fit_without_the_picture_predicts(basis: Basis, relief: Stack) -> None:
    """Against the long way: a fit of all other pictures for each."""
    fitted = start_fit(relief, LIGHTS, FitSettings(basis, "rgb"))
    report = report_on(fitted)
    pictures = (np.rint(relief_pictures(LIGHTS, 32) * 255) / 255).reshape(14, -1)
    design = basis.evaluate(LIGHTS)
    for index in range(14):
        others = np.arange(14) != index
        coefficients = np.linalg.lstsq(design[others], pictures[others], rcond=None)[0]
        error = np.mean((np.clip(design[index] @ coefficients, 0, 1) - pictures[index]) ** 2)
        assert report.left_out_db[index] == pytest.approx(-10 * np.log10(error), abs=0.01)
    assert report.worst(2) == list(np.argsort(report.left_out_db)[:2])


@pytest.mark.parametrize("colour", ["rgb", "lrgb"])
def test_each_light_fits_better_than_it_is_predicted(colour: Colour, relief: Stack) -> None:
    fitted = start_fit(relief, LIGHTS, FitSettings(colour=colour))
    report = report_on(fitted, ptm_coder(Path("x.ptm"), fitted).stored)
    assert np.all(report.left_out_db < report.per_light_db)
    assert report.stored_db is not None
    assert report.fit_db - 0.1 < report.stored_db < report.fit_db
    squared = np.mean(10 ** (-report.per_light_db / 10))
    assert report.fit_db == pytest.approx(-10 * np.log10(squared))


def test_a_wrong_direction_is_the_worst_light(relief: Stack) -> None:
    wrong = LIGHTS.copy()
    wrong[9, :2] *= -1
    fitted = start_fit(relief, wrong, FitSettings())
    report = report_on(fitted)
    assert report.worst(1) == [9]
    assert report.left_out_db[9] < np.delete(report.left_out_db, 9).min() - 2


def test_a_light_that_nothing_can_replace_is_not_left_out(relief: Stack) -> None:
    """Six pictures for six terms: each is needed."""
    stack = Stack(relief.paths[:6])
    fitted = start_fit(stack, LIGHTS[:6], FitSettings())
    report = report_on(fitted)
    assert np.isnan(report.left_out_db).all()
    lines = report.lines([path.name for path in stack.paths])
    assert "predicted by the others: - in all" in lines[-1]
    assert report.facts([path.name for path in stack.paths])["predicted_db"] is None


@pytest.mark.parametrize("robust", ["trimmed", "reweighted"])
def test_a_robust_fit_tells_how_much_it_counts(robust: Robust, relief: Stack) -> None:
    fitted = start_fit(relief, LIGHTS, FitSettings(robust=robust))
    report = report_on(fitted)
    assert 0.4 < report.kept_share < 0.95
    assert np.isfinite(report.left_out_db).all()


def test_a_spooled_fit_is_the_same(relief: Stack, tmp_path: Path) -> None:
    one = start_fit(relief, LIGHTS, FitSettings())
    other = start_fit(relief, LIGHTS, FitSettings(memory_bytes=1000, spool=tmp_path))
    rows = slice(5, 20)
    assert np.array_equal(one.strip(rows).coefficients, other.strip(rows).coefficients)
    assert report_on(one).fit_db == report_on(other).fit_db
