"""Materials as Blender's shader nodes: a Principled surface whose colour varies as model.Surface says."""

from __future__ import annotations

from dataclasses import dataclass

import bpy

from ..light.buffers import is_switched
from ..model import Material, Surface

# Blender's specular level 1 is a head-on reflection of 8 %.
F0_AT_LEVEL_ONE = 0.08
LEAST_ROUGHNESS = 0.02
# Smoother than this and not metal: paint and glass, which carry a clear coat.
COAT_GLOSS = 0.7
LAMP_STRENGTH = 12.0
WET_DARKENING = 0.5
# As cutout.glsl has them.
LEAF_M, GAP_SHARE = 0.09, 0.28
GROUND = (Surface.ASPHALT, Surface.PAVING)


@dataclass(frozen=True)
class Variation:
    """Two layers of noise: repeats per metre, and how far each one changes the brightness."""

    broad_scale: float
    broad_share: float
    fine_scale: float
    fine_share: float
    stretch: tuple[float, float, float] = (1.0, 1.0, 1.0)


VARIATIONS = {
    Surface.ASPHALT: Variation(0.25, 0.30, 45.0, 0.35),
    Surface.GRASS: Variation(0.6, 0.50, 30.0, 0.70),
    Surface.PAVING: Variation(0.7, 0.25, 30.0, 0.20),
    Surface.PLASTER: Variation(0.4, 0.22, 12.0, 0.10, (1.0, 1.0, 0.4)),
    Surface.BRICK: Variation(0.5, 0.20, 9.0, 0.25, (1.0, 1.0, 3.0)),
    Surface.FOLIAGE: Variation(0.9, 0.50, 9.0, 0.70),
    Surface.CLOTH: Variation(2.0, 0.30, 14.0, 0.35, (1.0, 1.0, 0.4)),
}
# Width, height and joint of bricks and slabs, m.
MASONRY = {Surface.PAVING: (0.5, 0.5, 0.012), Surface.BRICK: (0.24, 0.075, 0.010)}


@dataclass(frozen=True)
class Conditions:
    """What of a scene's light changes materials."""

    lamps_on: bool
    wetness: float


def build_material(material: Material, conditions: Conditions) -> bpy.types.Material:
    """A Blender material with the look of ours."""
    made = bpy.data.materials.new(material.name)
    made.use_nodes = True
    tree = made.node_tree
    shader = tree.nodes["Principled BSDF"]
    wet = conditions.wetness if material.surface in GROUND else 0.0
    colour = tuple(channel * (1.0 - WET_DARKENING * wet) for channel in material.colour)
    shader.inputs["Base Color"].default_value = (*colour, 1.0)
    shader.inputs["Metallic"].default_value = material.metallic
    shader.inputs["Roughness"].default_value = max(1.0 - material.gloss, LEAST_ROUGHNESS)
    shader.inputs["Specular IOR Level"].default_value = min(material.f0 / F0_AT_LEVEL_ONE, 1.0)
    if material.gloss > COAT_GLOSS and material.metallic < 0.5:
        shader.inputs["Coat Weight"].default_value = 0.8
        shader.inputs["Coat Roughness"].default_value = LEAST_ROUGHNESS
    _shine(shader, material, conditions.lamps_on)
    if material.surface is not Surface.PLAIN:
        _vary(tree, shader, colour, material.surface)
    if wet > 0.0:
        _wet(tree, shader, wet)
    if material.surface is Surface.FOLIAGE:
        _cut_gaps(tree, shader)
    return made


def _shine(shader: bpy.types.Node, material: Material, lamps_on: bool) -> None:
    if material.emission <= 0.0:
        return
    switched = is_switched(material.name)
    if switched and not lamps_on:
        return
    shader.inputs["Emission Color"].default_value = (*material.colour, 1.0)
    gain = LAMP_STRENGTH if switched else 1.0
    shader.inputs["Emission Strength"].default_value = material.emission * gain


def _vary(
    tree: bpy.types.NodeTree, shader: bpy.types.Node, colour: tuple[float, ...], surface: Surface
) -> None:
    """Feeds the base colour with the material's own, brighter and darker over the surface."""
    variation = VARIATIONS[surface]
    place = tree.nodes.new("ShaderNodeNewGeometry").outputs["Position"]
    stretched = _vector_math(tree, "MULTIPLY", place, variation.stretch)
    brightness = _layer(tree, stretched, variation.broad_scale, variation.broad_share)
    fine = _layer(tree, stretched, variation.fine_scale, variation.fine_share)
    factor = _math(tree, "MULTIPLY", brightness, fine)
    if surface in MASONRY:
        factor = _math(tree, "MULTIPLY", factor, _masonry(tree, surface))
    scaled = tree.nodes.new("ShaderNodeVectorMath")
    scaled.operation = "SCALE"
    scaled.inputs[0].default_value = colour
    tree.links.new(factor, scaled.inputs["Scale"])
    tree.links.new(scaled.outputs[0], shader.inputs["Base Color"])


def _layer(tree: bpy.types.NodeTree, place, scale: float, share: float):
    """Noise as a factor around 1."""
    noise = tree.nodes.new("ShaderNodeTexNoise")
    noise.inputs["Scale"].default_value = scale
    noise.inputs["Detail"].default_value = 5.0
    tree.links.new(place, noise.inputs["Vector"])
    return _map(tree, noise.outputs["Fac"], (0.3, 0.7), (1.0 - share, 1.0 + share))


def _masonry(tree: bpy.types.NodeTree, surface: Surface):
    """1 on bricks, less in joints; on walls the pattern runs along them, on the ground over x and y."""
    width, height, joint = MASONRY[surface]
    bricks = tree.nodes.new("ShaderNodeTexBrick")
    bricks.offset = 0.0 if surface is Surface.PAVING else 0.5
    values = {"Color1": 1.0, "Color2": 0.8, "Mortar": 0.55}
    for name, value in values.items():
        bricks.inputs[name].default_value = (value, value, value, 1.0)
    sizes = {"Scale": 1.0, "Mortar Size": joint / 2.0, "Brick Width": width, "Row Height": height}
    for name, value in sizes.items():
        bricks.inputs[name].default_value = value
    place = _ground_place(tree) if surface is Surface.PAVING else _wall_place(tree)
    tree.links.new(place, bricks.inputs["Vector"])
    return bricks.outputs["Color"]


def _ground_place(tree: bpy.types.NodeTree):
    return tree.nodes.new("ShaderNodeNewGeometry").outputs["Position"]


def _wall_place(tree: bpy.types.NodeTree):
    """Metres along the wall, then height."""
    geometry = tree.nodes.new("ShaderNodeNewGeometry")
    along = tree.nodes.new("ShaderNodeVectorMath")
    along.operation = "CROSS_PRODUCT"
    along.inputs[0].default_value = (0.0, 0.0, 1.0)
    tree.links.new(geometry.outputs["Normal"], along.inputs[1])
    dot = tree.nodes.new("ShaderNodeVectorMath")
    dot.operation = "DOT_PRODUCT"
    tree.links.new(along.outputs[0], dot.inputs[0])
    tree.links.new(geometry.outputs["Position"], dot.inputs[1])
    split = tree.nodes.new("ShaderNodeSeparateXYZ")
    tree.links.new(geometry.outputs["Position"], split.inputs[0])
    joined = tree.nodes.new("ShaderNodeCombineXYZ")
    tree.links.new(dot.outputs["Value"], joined.inputs["X"])
    tree.links.new(split.outputs["Z"], joined.inputs["Y"])
    return joined.outputs[0]


def _cut_gaps(tree: bpy.types.NodeTree, shader: bpy.types.Node) -> None:
    """Sees through between leaves: cells of a grid in model axes, of the light renderer's size and share."""
    place = tree.nodes.new("ShaderNodeTexCoord").outputs["Object"]
    cell = _vector_math(tree, "SNAP", place, (LEAF_M, LEAF_M, LEAF_M))
    noise = tree.nodes.new("ShaderNodeTexWhiteNoise")
    tree.links.new(cell, noise.inputs["Vector"])
    solid = tree.nodes.new("ShaderNodeMath")
    solid.operation = "GREATER_THAN"
    solid.inputs[1].default_value = GAP_SHARE
    tree.links.new(noise.outputs["Value"], solid.inputs[0])
    tree.links.new(solid.outputs[0], shader.inputs["Alpha"])


def _wet(tree: bpy.types.NodeTree, shader: bpy.types.Node, wetness: float) -> None:
    """Smooth puddles between damp ground."""
    noise = tree.nodes.new("ShaderNodeTexNoise")
    noise.inputs["Scale"].default_value = 0.35
    tree.links.new(_ground_place(tree), noise.inputs["Vector"])
    damp = 1.0 - 0.55 * wetness
    roughness = _map(tree, noise.outputs["Fac"], (0.45, 0.62), (damp, 1.0 - 0.94 * wetness))
    tree.links.new(roughness, shader.inputs["Roughness"])
    shader.inputs["Specular IOR Level"].default_value = 0.5


def _map(tree: bpy.types.NodeTree, value, source: tuple[float, float], target: tuple[float, float]):
    node = tree.nodes.new("ShaderNodeMapRange")
    for name, number in zip(("From Min", "From Max", "To Min", "To Max"), (*source, *target), strict=True):
        node.inputs[name].default_value = number
    tree.links.new(value, node.inputs["Value"])
    return node.outputs["Result"]


def _math(tree: bpy.types.NodeTree, operation: str, first, second):
    node = tree.nodes.new("ShaderNodeMath")
    node.operation = operation
    tree.links.new(first, node.inputs[0])
    tree.links.new(second, node.inputs[1])
    return node.outputs[0]


def _vector_math(tree: bpy.types.NodeTree, operation: str, first, second: tuple[float, float, float]):
    node = tree.nodes.new("ShaderNodeVectorMath")
    node.operation = operation
    tree.links.new(first, node.inputs[0])
    node.inputs[1].default_value = second
    return node.outputs[0]
