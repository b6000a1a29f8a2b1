"""Grades and refusals as Python sees them: plain words, records, and the vertices where a press failed."""

import numpy as np
import pytest

thenar = pytest.importorskip("thenar")


def sheet(spacing=1.0, count=21):
    """A flat patch in z = 0 that faces +z."""
    x, y = np.meshgrid(np.arange(count), np.arange(count), indexing="ij")
    points = np.stack([x - count // 2, y - count // 2, np.zeros_like(x)], axis=-1).reshape(-1, 3) * spacing
    corner = (np.arange(count - 1)[:, None] * count + np.arange(count - 1)).ravel()
    lower = np.stack([corner, corner + count, corner + count + 1], axis=1)
    upper = np.stack([corner, corner + count + 1, corner + 1], axis=1)
    return points.astype(float), np.concatenate([lower, upper]).astype(np.int32)


def block(bottom):
    """A cube of 60 mm whose lower side lies at z = `bottom`."""
    corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (0, 2)], float) * 30 + (0, 0, bottom)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = np.array([each for a, b, c, d in quads for each in ((a, b, c), (a, c, d))], np.int32)
    return corners, triangles


def test_a_grade_is_a_word_and_its_reason_a_warning():
    skin = thenar.Skin(*sheet())
    touching, apart = skin.press(*block(-0.5)), skin.press(*block(5.0))
    assert touching.grade in ("good", "read this")
    assert apart.grade == "do not use" and apart.reason in apart.warnings
    assert [remark.text for remark in apart.remarks] == apart.warnings
    assert {remark.grade for remark in apart.remarks} <= {"good", "read this", "do not use"}
    assert "no_contact" in [remark.kind for remark in apart.remarks]
    assert apart.contact_area_mm2 == 0.0 and not np.signbit(apart.contact_area_mm2)


def test_a_refusal_names_the_vertices_where_it_failed():
    points, triangles = sheet()
    skin = thenar.Skin(points, triangles)
    posed = points.copy()
    posed[:, 2] += 22.0 + 0.01 * (np.arange(len(points)) == 220)
    with pytest.raises(thenar.SolveError) as refused:
        skin.press(*block(0.0), posed_vertices_mm=posed)
    assert refused.value.vertices == [220]
    assert "22.0" in str(refused.value) and "vertex 220" in str(refused.value)
