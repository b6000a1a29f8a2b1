"""Materials that show a map over the user's own, and the way back to them."""

import bpy
from bpy.types import ColorRamp, Material, NodeTree, Object, PropertyGroup

from .. import colormap, maps, names
from . import contact_border

_SKIN = (0.80, 0.52, 0.40, 1.0)
_BARE = (0.62, 0.62, 0.60, 1.0)


def show(obj: Object, look: PropertyGroup, is_skin: bool) -> None:
    """Overlay the map on every material slot of `obj`; the slots' own materials stay in the mesh, untouched."""
    hide(obj)
    state = obj.thenar
    if not len(obj.data.materials):
        obj.data.materials.append(None)
        state.added_slot = True
    for slot in obj.material_slots:
        kept = state.slots.add()
        kept.link = slot.link
        own = slot.material
        if slot.link == "OBJECT":
            kept.material = own
        slot.link = "OBJECT"
        if slot.link == "OBJECT" and kept.link == "DATA":
            kept.material = slot.material if slot.material != own else None
        slot.material = _overlaid(own, look, is_skin)
    state.shows_pressure = True


def hide(obj: Object) -> None:
    """Give every slot its own material back and drop the overlaid copies."""
    state = obj.thenar
    if not state.shows_pressure:
        return
    for slot, kept in zip(obj.material_slots, state.slots, strict=False):
        copy = slot.material
        slot.link = "OBJECT"
        slot.material = kept.material
        slot.link = kept.link
        if copy is not None and _is_overlaid(copy) and copy.users == 0:
            bpy.data.materials.remove(copy)
    if state.added_slot and len(obj.material_slots):
        obj.data.materials.pop()
    state.added_slot = state.shows_pressure = False
    state.slots.clear()


def own_materials(obj: Object) -> list[Material | None]:
    """The user's material of every slot, also while a map is laid over them."""
    if not obj.thenar.shows_pressure:
        return [slot.material for slot in obj.material_slots]
    pairs = zip(obj.thenar.slots, obj.data.materials, strict=False)
    return [kept.material if kept.link == "OBJECT" else material for kept, material in pairs]


def update_group(look: PropertyGroup) -> None:
    """Set map, range and colours of the overlay that all overlaid materials share."""
    tree = bpy.data.node_groups.get(names.OVERLAY_GROUP)
    if tree is None:
        return
    if "Line" not in tree.nodes:  # a file of an earlier version
        _fill_group(tree)
    view = maps.shown(look)
    scale = maps.scale(view, look)
    tree.nodes["Value"].attribute_name = view.attribute
    tree.nodes["Cover"].attribute_name = maps.covering(view)
    tree.nodes["Range"].inputs["From Min"].default_value = scale.low
    tree.nodes["Range"].inputs["From Max"].default_value = scale.high
    for name, value in zip(("From Min", "From Max"), scale.edge, strict=True):
        tree.nodes["Edge"].inputs[name].default_value = value
    tree.nodes["Line Shown"].inputs[1].default_value = float(maps.has_line(view, look))
    _fill_ramp(tree.nodes["Ramp"].color_ramp, scale.palette)


def _is_overlaid(material: Material) -> bool:
    nodes = material.node_tree.nodes if material.node_tree is not None else ()
    group = bpy.data.node_groups.get(names.OVERLAY_GROUP)
    return any(node.type == "GROUP" and node.node_tree == group for node in nodes)


def _overlaid(own: Material | None, look: PropertyGroup, is_skin: bool) -> Material:
    base = own.copy() if own is not None else _plain(is_skin)
    stem = own.name if own is not None else ("Skin" if is_skin else "Product")
    base.name = names.suffixed(stem, names.MATERIAL_SUFFIX)
    if base.node_tree is None or (bpy.app.version < (5, 0) and not base.use_nodes):
        base.use_nodes = True
    tree = base.node_tree
    output = tree.get_output_node("ALL") or tree.get_output_node("CYCLES") or tree.nodes.new("ShaderNodeOutputMaterial")
    overlay = tree.nodes.new("ShaderNodeGroup")
    overlay.node_tree = _group(look)
    overlay.location = (output.location.x, output.location.y + 180)
    surface = output.inputs["Surface"]
    if surface.is_linked:
        tree.links.new(surface.links[0].from_socket, overlay.inputs["Surface"])
    tree.links.new(overlay.outputs["Surface"], surface)
    return base


def _plain(is_skin: bool) -> Material:
    material = bpy.data.materials.new("plain")
    if material.node_tree is None:
        material.use_nodes = True
    shader = next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    shader.inputs["Base Color"].default_value = _SKIN if is_skin else _BARE
    shader.inputs["Roughness"].default_value = 0.5 if is_skin else 0.35
    if is_skin:
        shader.inputs["Subsurface Weight"].default_value = 0.12
        shader.inputs["Subsurface Radius"].default_value = (1.0, 0.35, 0.2)
        shader.inputs["Subsurface Scale"].default_value = 0.004
    return material


def _group(look: PropertyGroup) -> NodeTree:
    tree = bpy.data.node_groups.get(names.OVERLAY_GROUP)
    if tree is None:
        tree = _new_group()
    update_group(look)
    return tree


def _new_group() -> NodeTree:
    tree = bpy.data.node_groups.new(names.OVERLAY_GROUP, "ShaderNodeTree")
    tree.interface.new_socket("Surface", in_out="INPUT", socket_type="NodeSocketShader")
    tree.interface.new_socket("Surface", in_out="OUTPUT", socket_type="NodeSocketShader")
    _fill_group(tree)
    return tree


def _fill_group(tree: NodeTree) -> None:
    """The map where it covers the surface, a line along its edge, the user's own shader elsewhere."""
    nodes, links = tree.nodes, tree.links
    nodes.clear()
    entry, leave = nodes.new("NodeGroupInput"), nodes.new("NodeGroupOutput")
    value, cover = nodes.new("ShaderNodeAttribute"), nodes.new("ShaderNodeAttribute")
    value.name, cover.name = "Value", "Cover"
    value.attribute_type = cover.attribute_type = "GEOMETRY"
    fraction, edge = nodes.new("ShaderNodeMapRange"), nodes.new("ShaderNodeMapRange")
    fraction.name, fraction.clamp = "Range", True
    edge.name, edge.interpolation_type = "Edge", "SMOOTHSTEP"
    ramp = nodes.new("ShaderNodeValToRGB")
    ramp.name = "Ramp"
    light, mix = nodes.new("ShaderNodeEmission"), nodes.new("ShaderNodeMixShader")
    links.new(value.outputs["Fac"], fraction.inputs["Value"])
    links.new(cover.outputs["Fac"], edge.inputs["Value"])
    links.new(fraction.outputs["Result"], ramp.inputs["Fac"])
    links.new(ramp.outputs["Color"], light.inputs["Color"])
    links.new(edge.outputs["Result"], mix.inputs[0])
    links.new(entry.outputs["Surface"], mix.inputs[1])
    links.new(light.outputs["Emission"], mix.inputs[2])
    lined = contact_border.lined(tree, cover, mix)
    links.new(lined.outputs["Shader"], leave.inputs["Surface"])
    for place, node in enumerate(nodes):
        node.location = (place % 7 * 220 - 900, -300 * (place // 7))


def _fill_ramp(ramp: ColorRamp, palette: str) -> None:
    colors = colormap.to_linear(colormap.stops(palette))
    elements = ramp.elements
    while len(elements) > len(colors):
        elements.remove(elements[-1])
    while len(elements) < len(colors):
        elements.new(1.0)
    for index, color in enumerate(colors):
        elements[index].position = index / (len(colors) - 1)
        elements[index].color = (*color, 1.0)
