"""Blender properties of a made hand: what shape and look it has. A change of the shape makes the hand over in place."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, FloatVectorProperty, PointerProperty, StringProperty

from .. import native
from ..operators.running import sentence
from ..scene.checks import Refusal
from . import built, editing, skin_look

SIZES = (
    ("PERCENTILE", "Percentile", "Length and breadth of this percentile of adults of that sex"),
    ("OWN", "Measured", "A person's own hand length and breadth"),
)
NAILS = (
    ("NATURAL", "Natural", "Nail bed, moon and free edge"),
    ("POLISH", "Polish", "Nails of one color"),
    ("NONE", "None", "Nails are drawn as skin"),
)
_filling = []
"""Not empty while properties are written that shall not change the hand."""


def _shape_changed(self, context):
    if _filling or not self.is_made:
        return
    try:
        editing.reshape(context, self.id_data, self.wanted())
        self.problem = ""
    except (Refusal, *native.error_types()) as error:
        self.problem, chosen = sentence(error), self.size
        self.show(built.from_text(self.built), chosen)


def _percentile_changed(self, context):
    self.choose("PERCENTILE")
    _shape_changed(self, context)


def _measure_changed(self, context):
    self.choose("OWN")
    _shape_changed(self, context)


def _size_changed(self, context):
    if self.size == "PERCENTILE":
        _shape_changed(self, context)


def _look_changed(self, _context):
    if not _filling:
        skin_look.apply(self.id_data)


class ThenarHandShape(bpy.types.PropertyGroup):
    """`object.thenar_hand`: shape and look of a hand that Thenar made. The units of the shape are mm."""

    is_made: BoolProperty(options={"HIDDEN"})
    built: StringProperty(options={"HIDDEN"})
    problem: StringProperty(options={"HIDDEN"})
    sex: EnumProperty(
        name="Sex",
        description="Sex whose measured sizes the hand has",
        items=(("male", "Male", ""), ("female", "Female", "")),
        options=set(),
        update=_shape_changed,
    )
    side: EnumProperty(
        name="Side",
        description="Right or left hand",
        items=(("right", "Right", ""), ("left", "Left", "")),
        options=set(),
        update=_shape_changed,
    )
    size: EnumProperty(
        name="Size", description="Size by percentile, or measured", items=SIZES, options=set(), update=_size_changed
    )
    percentile: FloatProperty(
        name="Percentile",
        description="Size among adults of that sex",
        min=1.0,
        max=99.0,
        default=50.0,
        options=set(),
        update=_percentile_changed,
    )
    length_mm: FloatProperty(
        name="Length (mm)",
        description="Wrist crease to the tip of the middle finger, fingers straight, mm",
        min=1.0,
        default=189.0,
        precision=1,
        step=100,
        options=set(),
        update=_measure_changed,
    )
    breadth_mm: FloatProperty(
        name="Breadth (mm)",
        description="Across the heads of the metacarpals, without the thumb, mm",
        min=1.0,
        default=87.0,
        precision=1,
        step=100,
        options=set(),
        update=_measure_changed,
    )
    tone: FloatProperty(
        name="Tone",
        description="Skin tone from 1 (very light) to 6 (very dark), after Fitzpatrick's six types",
        min=1.0,
        max=6.0,
        default=2.0,
        options=set(),
        update=_look_changed,
    )
    age: FloatProperty(
        name="Age",
        description="Years; deepens creases and wrinkles, roughens the skin and spots the back of the hand",
        min=18.0,
        max=100.0,
        default=30.0,
        precision=0,
        step=100,
        options=set(),
        update=_look_changed,
    )
    nails: EnumProperty(name="Nails", description="Look of the nails", items=NAILS, options=set(), update=_look_changed)
    polish: FloatVectorProperty(
        name="Polish",
        description="Color of the polish",
        subtype="COLOR",
        size=3,
        min=0.0,
        max=1.0,
        default=(0.45, 0.02, 0.04),
        options=set(),
        update=_look_changed,
    )

    def wanted(self):
        """Keywords of `thenar.hand` for the properties as they are."""
        shape = {"sex": self.sex, "side": self.side, "percentile": self.percentile}
        if self.size == "OWN":
            shape |= {"length_mm": self.length_mm, "breadth_mm": self.breadth_mm}
        return shape

    def keep(self, made):
        """Note how the hand is made now (`built.Built`), and show it."""
        self.built = made.as_text()
        self.is_made = True
        self.show(made)

    def choose(self, size):
        """Set where the size comes from without making the hand over."""
        if not _filling:
            _filling.append(size)
            self.size = size
            _filling.pop()

    def show(self, made, size=None):
        """Set the properties to a `built.Built` without making the hand over; `size`: its own choice if None."""
        _filling.append(made)
        own = {"length_mm", "breadth_mm"} & set(made.shape)
        self.size = size or ("OWN" if own else "PERCENTILE")
        for name in ("sex", "side", "percentile"):
            if name in made.shape:
                setattr(self, name, made.shape[name])
        self.length_mm, self.breadth_mm = built.measures_mm(made)
        _filling.pop()


def register():
    """Register the class and hang it on objects."""
    bpy.utils.register_class(ThenarHandShape)
    bpy.types.Object.thenar_hand = PointerProperty(type=ThenarHandShape)


def unregister():
    """Take it off again."""
    del bpy.types.Object.thenar_hand
    bpy.utils.unregister_class(ThenarHandShape)
