"""What a scene keeps of its grasps: those found for the product, and what the hand shall hold."""

import json

import bpy
import numpy as np
from bpy.props import CollectionProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty, StringProperty

FRICTION = 0.38
"""Static friction of palmar skin on aluminium; 0.50 on textured vinyl, 0.27 on paper (Buchholz 1988)."""

WEIGHT_MOST_N = 500.0

MOVES = (
    ("AUTO", "Automatic", "The hand goes to the product; where it is part of a body, the product comes to the hand"),
    ("HAND", "Hand", "The hand goes to the product"),
    ("PRODUCT", "Product", "The product comes to the hand"),
    ("FINGERS", "Fingers Only", "Hand and product stay; only the fingers close"),
)


class ThenarGrasp(bpy.types.PropertyGroup):
    """A grasp that was found: `pose` holds angles and the hand's place on the product as JSON; `kind` one of
    `ways`; `facts` and `picture` are of `grasp_choices`; the rest says what it carries when it is pressed."""

    pose: StringProperty()
    kind: StringProperty()
    total_n: FloatProperty()
    net_n: FloatProperty()
    friction: FloatProperty()
    score: FloatProperty()
    facts: StringProperty()
    picture: StringProperty()


FIELDS = ("pose", "kind", "total_n", "net_n", "friction", "score", "facts", "picture")


class ThenarGrasps(bpy.types.PropertyGroup):
    """`scene.thenar_grasps`: the grasps found, best first, and the settings of *Settle*."""

    found: CollectionProperty(type=ThenarGrasp)
    shown: IntProperty(default=-1)
    product: StringProperty()
    hand: StringProperty()
    weight_n: FloatProperty(
        name="Weight (N)",
        description="Weight of the product, N, which acts downward at its middle; 0 balances the forces alone",
        min=0.0,
        max=WEIGHT_MOST_N,
    )
    total_n: FloatProperty(
        name="Grip (N)",
        description="Sum of forces that the skin shall carry, N; 0 keeps what the current pose carries",
        min=0.0,
        soft_max=400.0,
    )
    moves: EnumProperty(
        name="Moves",
        description="What a grasp moves, apart from the fingers: the hand, the product, or neither",
        items=MOVES,
        default="AUTO",
    )
    friction: FloatProperty(
        name="Friction",
        description="Coefficient of friction between skin and product that holds what the normal forces leave over",
        min=0.0,
        max=2.0,
        default=FRICTION,
    )

    def placed(self):
        """What a grasp that has a place of its own moves: `moves`, or its default where that is the fingers alone."""
        return "AUTO" if self.moves == "FINGERS" else self.moves


def keep(scene, names, rows):
    """Write the grasps found, best first; the first is shown. `rows`: values by property of `ThenarGrasp`."""
    stored = scene.thenar_grasps
    stored.hand, stored.product = names
    stored.found.clear()
    for values in rows:
        row = stored.found.add()
        for name, value in values.items():
            setattr(row, name, value)
    stored.shown = 0 if rows else -1


def packed(angles, place):
    """Angles (b, 3), radians, and a place (4, 4), mm, as one text."""
    return json.dumps({"angles": np.round(angles, 9).tolist(), "place": np.round(place, 6).tolist()})


def unpacked(text):
    """The same back."""
    stored = json.loads(text)
    return np.array(stored["angles"]), np.array(stored["place"])


CLASSES = (ThenarGrasp, ThenarGrasps)


def register_properties():
    """Hang the grasps on scenes."""
    bpy.types.Scene.thenar_grasps = PointerProperty(type=ThenarGrasps)


def unregister_properties():
    """Take them off again."""
    del bpy.types.Scene.thenar_grasps
