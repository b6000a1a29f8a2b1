"""The kinds of rigs by maker, one function each: `KINDS` holds them all."""

import bodies
import numpy as np
from bodies import DIGITS
from kinds import Made, face, fingers, s, toes, trunk

WORDS = {"thumb": "Thumb", "index": "Index", "middle": "Middle", "ring": "Ring", "little": "Pinky"}
NUMBER = {digit: number for number, digit in enumerate(DIGITS, 1)}


def makehuman():
    """MakeHuman and MPFB, default rig (mpfb2, rigs/standard/rig.default.json): numbered fingers, toes, face."""
    made = Made()
    spine = ("root", "spine05", "spine03", "spine02", "spine01", "neck01", "head")
    hands, feet = trunk(
        made,
        spine,
        lambda side: [
            f"{n}.{s(side, 'R', 'L')}" for n in ("clavicle", "upperarm01", "lowerarm01", "lowerarm02", "wrist")
        ],
        lambda side: [f"{n}.{s(side, 'R', 'L')}" for n in ("upperleg01", "lowerleg01", "foot")],
    )
    toes(made, feet, lambda side, number, k: f"toe{number + 1}-{k}.{s(side, 'R', 'L')}")
    face(made, "head", lambda number, k: f"{('oris', 'levator', 'orbicularis', 'tongue')[number]}0{k + 1}", 4)
    for side, hand in hands.items():
        mark = s(side, "R", "L")
        fingers(
            made,
            side,
            hand,
            lambda d, k, m=mark: f"finger{NUMBER[d]}-{k}.{m}" if k else f"metacarpal{NUMBER[d] - 1}.{m}",
            metacarpals=True,
        )
    return made


def unreal4():
    """Unreal mannequin of UE4, MakeHuman's game_engine rig (mpfb2, rig.game_engine.json) with the same names."""
    return _unreal(False)


def unreal5():
    """Unreal mannequin of UE5: metacarpals, twist bones, bulge bones on the fingers."""
    return _unreal(True)


def _unreal(is_new):
    made = Made()
    spine = ("pelvis", "spine_01", "spine_02", "spine_03", "neck_01", "head")
    hands, feet = trunk(
        made,
        ("root", *spine),
        lambda side: [f"{n}_{side[0]}" for n in ("clavicle", "upperarm", "lowerarm", "hand")],
        lambda side: [f"{n}_{side[0]}" for n in ("thigh", "calf", "foot", "ball")],
    )
    for side, hand in hands.items():
        mark = side[0]
        places = bodies.arm(dict(bodies.sides())[side])
        made.builder.add(f"lowerarm_twist_01_{mark}", f"lowerarm_{mark}", places[3])
        word = {"little": "pinky"}
        fingers(
            made,
            side,
            hand,
            lambda d, k, m=mark, w=word: f"{w.get(d, d)}_0{k}_{m}" if k else f"{w.get(d, d)}_metacarpal_{m}",
            metacarpals=is_new,
        )
        if is_new:
            for digit in ("index", "thumb"):
                at = next(row[2] for row in made.builder.rows if row[0] == f"{digit}_02_{mark}")
                made.builder.add(f"{digit}_02_bulge_{mark}", f"{digit}_02_{mark}", at + 3.0)
            made.builder.add(f"wrist_inner_{mark}", hand, places[4] + 5.0)
    return made


def mixamo():
    """Mixamo (mpfb2, rig.mixamo.json; Mixamo's FBX): colon in names, a fourth bone without skin at each tip."""
    made = Made()
    names = [f"mixamorig:{n}" for n in ("Hips", "Spine", "Spine1", "Spine2", "Neck", "Head")]
    hands, _ = trunk(
        made,
        names,
        lambda side: [f"mixamorig:{side.title()}{n}" for n in ("Shoulder", "Arm", "ForeArm", "Hand")],
        lambda side: [f"mixamorig:{side.title()}{n}" for n in ("UpLeg", "Leg", "Foot", "ToeBase")],
    )
    for side, hand in hands.items():
        fingers(made, side, hand, lambda d, k, h=hand: f"{h}{WORDS[d]}{k}", tips=True)
    return made


def mixamo_with_tip_weights():
    """Mixamo hands on which automatic weights gave the leaf bones skin as well."""
    made = Made()
    for side in ("right", "left"):
        hand = made.builder.add(f"mixamorig:{side.title()}Hand", None, bodies.place_hand(_sign(side), np.zeros(3)))
        fingers(made, side, hand, lambda d, k, h=hand: f"{h}{WORDS[d]}{k}", tips=True, tip_skin=True)
    return made


def rigify_metarig():
    """Rigify's human metarig (Blender, rigify/metarigs/human.py): palms start off the hand, thumb on palm.01."""
    return _rigify("")


def rigify_deform():
    """Rigify's generated rig: DEF bones on ORG bones that carry no skin."""
    return _rigify("DEF-")


def _rigify(prefix):
    made = Made()
    add = made.builder.add
    spine = [f"{prefix}spine{end}" for end in ("", ".001", ".002", ".003", ".004", ".005")]
    hands, _ = trunk(
        made,
        spine,
        lambda side: [f"{prefix}{n}.{s(side, 'R', 'L')}" for n in ("shoulder", "upper_arm", "forearm", "hand")],
        lambda side: [f"{prefix}{n}.{s(side, 'R', 'L')}" for n in ("thigh", "shin", "foot", "toe")],
    )
    points = bodies.hand_points()
    for side, hand in hands.items():
        mark, on = s(side, "R", "L"), {}
        root = hand
        if prefix:
            root = add(f"ORG-hand.{mark}", spine[2], bodies.place_hand(_sign(side), np.zeros(3)), False)
        for number, digit in enumerate(DIGITS[1:], 1):
            at = bodies.place_hand(_sign(side), points[digit, 0])
            name = f"palm.0{number}.{mark}"
            parent = add(f"ORG-{name}", root, at, False) if prefix else root
            palm = add(prefix + name, parent, at)
            on[digit] = parent if prefix else palm
            made.truth[side][f"{digit}_metacarpal"] = palm
        on["thumb"] = on["index"]

        def named(digit, k, m=mark):
            word = {"thumb": "thumb", "little": "f_pinky"}.get(digit, f"f_{digit}")
            return f"{prefix}{word}.0{k}.{m}"

        fingers(made, side, hand, named, on=on)
    return made


def auto_rig_pro_bone(digit, k):
    """Name without the side of a bone that carries skin: the finger's first phalanx and the thumb's metacarpal lack the
    c_ of controls, all others are controls too (as public scripts map
    them to Daz and Unreal)."""
    word = {"little": "pinky"}.get(digit, digit)
    return {0: f"c_{word}1_base", 1: f"{word}1"}.get(k, f"c_{word}{k}")


def auto_rig_pro():
    """Auto-Rig Pro: lower-case sides, c_index1_base metacarpals, bones without skin that bend all phalanges at once."""
    made = Made()
    hands, _ = trunk(
        made,
        ("root.x", "spine_01.x", "spine_02.x", "spine_03.x", "neck.x", "head.x"),
        lambda side: [f"{n}.{side[0]}" for n in ("shoulder", "arm_stretch", "forearm_stretch", "hand")],
        lambda side: [f"{n}.{side[0]}" for n in ("thigh_stretch", "leg_stretch", "foot", "toes_01")],
    )
    for side, hand in hands.items():
        made.builder.add(f"forearm_twist.{side[0]}", f"forearm_stretch.{side[0]}", bodies.arm(_sign(side))[3])
        word = {"little": "pinky"}
        fingers(
            made,
            side,
            hand,
            lambda d, k, m=side[0]: f"{auto_rig_pro_bone(d, k)}.{m}",
            metacarpals=True,
            helper=lambda d, k, m=side[0], w=word: f"c_{w.get(d, d)}{k}_rot.{m}" if k else None,
        )
    return made


def openxr():
    """OpenXR and WebXR hand of 25 joints (W3C WebXR Hand Input, 5.1) with a hierarchy; tips without skin."""
    return _openxr(False)


def openxr_with_tip_weights():
    """The same with some skin on the tips: chains of five bones."""
    return _openxr(True)


def _openxr(tip_skin):
    made = Made()
    for side in ("right", "left"):
        wrist = made.builder.add(f"{side}-wrist", None, bodies.place_hand(_sign(side), np.zeros(3)))
        ends = ("metacarpal", "phalanx-proximal", "phalanx-intermediate", "phalanx-distal", "tip")
        thumb = ("", "metacarpal", "phalanx-proximal", "phalanx-distal", "tip")

        def named(digit, k, m=side, ends=ends, thumb=thumb):
            word = "pinky" if digit == "little" else digit
            return f"{m}-thumb-{thumb[k]}" if digit == "thumb" else f"{m}-{word}-finger-{ends[k]}"

        fingers(made, side, wrist, named, metacarpals=True, tips=True, tip_skin=tip_skin)
    return made


def openxr_flat():
    """The same as the WebXR input profiles' GLB has it: every joint a root, fingertips first in the file."""
    made = openxr()
    made.builder.rows = [(name, None, place, skin) for name, _, place, skin in reversed(made.builder.rows)]
    return made


def vroid():
    """VRM of VRoid Studio: J_Bip names, strands of hair and a skirt of chains like fingers."""
    made = Made()
    hands, _ = trunk(
        made,
        [f"J_Bip_C_{n}" for n in ("Hips", "Spine", "Chest", "UpperChest", "Neck", "Head")],
        lambda side: [f"J_Bip_{side[0].upper()}_{n}" for n in ("Shoulder", "UpperArm", "LowerArm", "Hand")],
        lambda side: [f"J_Bip_{side[0].upper()}_{n}" for n in ("UpperLeg", "LowerLeg", "Foot", "ToeBase")],
    )
    word = {**WORDS, "little": "Little"}
    for side, hand in hands.items():
        mark = s(side, "R", "L")
        fingers(made, side, hand, lambda d, k, m=mark: f"J_Bip_{m}_{word[d]}{k}")
    _ring(made, "J_Bip_C_Head", lambda number, k: f"J_Sec_Hair{k + 1}_0{number + 1}", (90.0, 1650.0, 60.0))
    _ring(made, "J_Bip_C_Hips", lambda number, k: f"J_Sec_Skirt{number}_{k}", (130.0, 960.0, 110.0))
    return made


def _ring(made, parent, name, sizes):
    """Five chains that hang from a ring: `sizes` radius, height, length of a bone."""
    radius, height, length = sizes
    for number in range(5):
        angle = 2.0 * np.pi * number / 5
        place = np.array([radius * np.cos(angle), radius * np.sin(angle), height])
        step = np.array([0.3 * np.cos(angle), 0.3 * np.sin(angle), -1.0]) * length
        made.builder.chain(parent, *[(name(number, k), place + k * step) for k in range(3)])


def daz8():
    """Daz Genesis 3 and 8: side as a small letter in front, carpals, bend and twist bones, toes of two bones."""
    made = Made()
    hands, feet = trunk(
        made,
        ("hip", "abdomenLower", "abdomenUpper", "chestLower", "chestUpper", "neckLower", "head"),
        lambda side: [side[0] + n for n in ("Collar", "ShldrBend", "ForearmBend", "ForearmTwist", "Hand")],
        lambda side: [side[0] + n for n in ("ThighBend", "Shin", "Foot", "Toe")],
    )
    toes(
        made,
        feet,
        lambda side, number, k: side[0] + (f"SmallToe{number}" if number else "BigToe") + ("" if k == 1 else "_2"),
        (2, 2, 2, 2, 2),
    )
    word = {**WORDS, "middle": "Mid"}
    for side, hand in hands.items():

        def named(digit, k, m=side[0]):
            return f"{m}{word[digit]}{k}" if k else f"{m}Carpal{NUMBER[digit] - 1}"

        fingers(made, side, hand, named, metacarpals=True)
    return made


def daz9():
    """Daz Genesis 9: l_index1, metacarpals of their own names, toes l_bigtoe1."""
    made = Made()
    hands, feet = trunk(
        made,
        ("hip", "spine1", "spine2", "spine3", "spine4", "neck1", "head"),
        lambda side: [f"{side[0]}_{n}" for n in ("shoulder", "upperarm", "forearm", "hand")],
        lambda side: [f"{side[0]}_{n}" for n in ("thigh", "shin", "foot", "toes")],
    )
    word = {"middle": "mid", "little": "pinky"}
    names = ("bigtoe", "indextoe", "midtoe", "ringtoe", "pinkytoe")
    toes(made, feet, lambda side, number, k: f"{side[0]}_{names[number]}{k}", (2, 2, 2, 2, 2))
    for side, hand in hands.items():

        def named(digit, k, m=side[0]):
            return f"{m}_{word.get(digit, digit)}{k}" if k else f"{m}_{word.get(digit, digit)}metacarpal"

        fingers(made, side, hand, named, metacarpals=True)
    return made


def character_creator():
    """AccuRig and Character Creator: CC_Base names, twist and share bones, toes of one bone."""
    made = Made()
    names = (
        "CC_Base_Hip",
        "CC_Base_Waist",
        "CC_Base_Spine01",
        "CC_Base_Spine02",
        "CC_Base_NeckTwist01",
        "CC_Base_Head",
    )
    hands, feet = trunk(
        made,
        names,
        lambda side: [f"CC_Base_{side[0].upper()}_{n}" for n in ("Clavicle", "Upperarm", "Forearm", "Hand")],
        lambda side: [f"CC_Base_{side[0].upper()}_{n}" for n in ("Thigh", "Calf", "Foot", "ToeBase")],
    )
    word = {**WORDS, "middle": "Mid"}
    kinds = ("Big", "Index", "Mid", "Ring", "Pinky")
    toes(made, feet, lambda side, n, k: f"CC_Base_{side[0].upper()}_{kinds[n]}Toe{k}", (1, 1, 1, 1, 1))
    for side, hand in hands.items():
        mark = side[0].upper()
        for number, at in ((1, 3), (2, 4)):
            twist = f"CC_Base_{mark}_ForearmTwist0{number}"
            made.builder.add(twist, f"CC_Base_{mark}_Forearm", bodies.arm(_sign(side))[at])
        fingers(made, side, hand, lambda d, k, m=mark: f"CC_Base_{m}_{word[d]}{k}")
    return made


def unity():
    """Unity humanoid bones (HumanBodyBones): LeftIndexProximal, LeftIndexIntermediate, LeftIndexDistal."""
    made = Made()
    hands, _ = trunk(
        made,
        ("Hips", "Spine", "Chest", "UpperChest", "Neck", "Head"),
        lambda side: [side.title() + n for n in ("Shoulder", "UpperArm", "LowerArm", "Hand")],
        lambda side: [side.title() + n for n in ("UpperLeg", "LowerLeg", "Foot", "Toes")],
    )
    ends = ("", "Proximal", "Intermediate", "Distal")
    for side, hand in hands.items():
        mark = s(side, "Right", "Left")
        fingers(made, side, hand, lambda d, k, m=mark: m + {**WORDS, "little": "Little"}[d] + ends[k])
    return made


def smplx():
    """SMPL-X (joint names of the smplx package): left_index1..3, thumb and pinky in another order."""
    made = Made()
    hands, _ = trunk(
        made,
        ("pelvis", "spine1", "spine2", "spine3", "neck", "head"),
        lambda side: [f"{side}_{n}" for n in ("collar", "shoulder", "elbow", "wrist")],
        lambda side: [f"{side}_{n}" for n in ("hip", "knee", "ankle", "foot")],
    )
    for side, hand in hands.items():
        word = {"little": "pinky"}
        order = ("index", "middle", "little", "ring", "thumb")
        fingers(made, side, hand, lambda d, k, m=side, w=word: f"{m}_{w.get(d, d)}{k}", digits=order)
    return made


def biped():
    """3ds Max Biped: Bip01 R Finger0, Finger01, Finger02 for the thumb, numbers without words, nubs at the ends."""
    made = Made()
    hands, _ = trunk(
        made,
        [f"Bip01 {n}" for n in ("Pelvis", "Spine", "Spine1", "Spine2", "Neck", "Head")],
        lambda side: [f"Bip01 {side[0].upper()} {n}" for n in ("Clavicle", "UpperArm", "Forearm", "Hand")],
        lambda side: [f"Bip01 {side[0].upper()} {n}" for n in ("Thigh", "Calf", "Foot", "Toe0")],
    )
    for side, hand in hands.items():
        mark = s(side, "R", "L")

        def named(digit, k, m=mark):
            end = "" if k == 1 else "Nub" if k == 4 else str(k - 1)
            return f"Bip01 {m} Finger{NUMBER[digit] - 1}{end}"

        fingers(made, side, hand, named, tips=True)
    return made


def bvh():
    """BVH of motion capture gloves: HumanIK names without prefix, metacarpals as InHand bones, End Sites."""
    made = Made()
    hands, _ = trunk(
        made,
        ("Hips", "Spine", "Spine1", "Spine2", "Neck", "Head"),
        lambda side: [side.title() + n for n in ("Shoulder", "Arm", "ForeArm", "Hand")],
        lambda side: [side.title() + n for n in ("UpLeg", "Leg", "Foot")],
    )
    for side, hand in hands.items():

        def named(digit, k, h=hand):
            if k == 4:
                return f"{h}{WORDS[digit]}3_EndSite"
            return f"{h}{WORDS[digit]}{k}" if k else f"{h.replace('Hand', 'InHand')}{WORDS[digit]}"

        fingers(made, side, hand, named, metacarpals=True, tips=True)
    return made


def _sign(side):
    return dict(bodies.sides())[side]


_ALL = (makehuman, unreal4, unreal5, mixamo, mixamo_with_tip_weights, rigify_metarig, rigify_deform, auto_rig_pro) + (
    openxr,
    openxr_with_tip_weights,
    openxr_flat,
    vroid,
    daz8,
    daz9,
    character_creator,
    unity,
    smplx,
    biped,
    bvh,
)
KINDS = {function.__name__: function for function in _ALL}
