"""A hand made and grasps fitted: how long each takes is printed beside what it did (`pytest -s`), never asserted."""

import time

import pytest
import thenar
from hand_scenes import triangles_of
from thenar_blender.grasp import fitting
from thenar_blender.grasp_fit import fitter
from thenar_blender.hand import build, pads, products
from thenar_blender.hand_look import studio
from thenar_blender.recordings import table_6
from thenar_blender.scene import units

UPRIGHT = {"axis": (0.0, 0.0, 1.0), "center": (0.0, 0.0, 0.0)}


def timed(action, *arguments):
    """What `action` returns, and the seconds of the clock and of the processor that it took."""
    began = time.perf_counter(), time.process_time()
    value = action(*arguments)
    return value, time.perf_counter() - began[0], time.process_time() - began[1]


def test_hand_made():
    made, clock, work = timed(thenar.hand)
    print(f"hand of {len(made['vertices_mm'])} vertices made: {clock:.2f} s, {work:.2f} s of processor")
    assert len(made["region_names"]) == 19 and len(made["bones"]) == made["weights"].shape[1]


@pytest.mark.parametrize("targets", [pads.LIGHT_MM, pads.FIRM_MM], ids=["light", "firm"])
@pytest.mark.parametrize("diameter", [48, 60, 100])
def test_grasp_fitted(arrays, diameter, targets):
    vertices, faces = products.cylinder(diameter)
    product = thenar.Product(vertices, triangles_of(faces))
    found, clock, work = timed(fitter.fit, arrays, product, vertices, fitter.Wish(targets, **UPRIGHT))
    misses = sorted(abs(found.depths_mm[name] - want) for name, want in found.targets_mm.items())
    print(
        f"{diameter} mm cylinder, palm {targets['palm']} mm deep: {clock:.2f} s, {work:.2f} s of processor; "
        f"{found.evaluations} evaluations, {len(misses)} pads, misses {misses[len(misses) // 2]:.2f} median, "
        f"{misses[-1]:.2f} mm most"
    )
    assert not found.warnings


@pytest.mark.parametrize("diameter", table_6.PAPER)
def test_grasp_fitted_to_a_force(blender, made, diameter):
    context = blender.context
    studio.set_units(context.scene)
    hand, _ = build.add_hand(context, made)
    material = studio.plain("Any", (0.5, 0.5, 0.5, 1.0), 0.5)
    product = studio.add_mesh(context, "Product", products.cylinder(diameter), material)
    context.view_layer.update()
    context.scene.thenar.hand, context.scene.thenar.product = hand, product
    assert units.mm_per_unit(context.scene) == 1000.0
    wanted = table_6.PAPER[diameter]["force_n"][0]
    job = fitting.prepare(context, hand, [product], fitter.Wish(pads.FIRM_MM, **UPRIGHT), wanted)
    found, clock, work = timed(fitting.compute, job)
    print(f"{diameter} mm cylinder, {wanted:.0f} N: {clock:.2f} s, {work:.2f} s of processor; {found.force_n:.1f} N")
    assert found.force_n == pytest.approx(wanted, rel=0.02)
    fitting.finish(context, job, found, "HAND")
    assert blender.ops.thenar.solve() == {"FINISHED"}
    result = context.scene.thenar.result
    print("\n".join(table_6.lines(table_6.read_scene(context))))
    assert result.force_n == pytest.approx(found.force_n, rel=0.01)
    touching = {region.name for region in result.regions if region.force_n > 0.0}
    assert len(touching) == 19, "every region touches in the paper's grasps"
