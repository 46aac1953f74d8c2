"""Sun and sky in Blender, with the colours of the light renderer."""

from __future__ import annotations

import math

import bpy
import mathutils

from ..light.lighting import Lighting

# A little wider than the real sun: edges of shadows soften as in hazy air.
SUN_ANGLE_RAD = math.radians(1.2)
CLOUD_SCALE = 2.2
SKY_MAP_PX = 256


def set_sky(scene: bpy.types.Scene, lighting: Lighting) -> None:
    """Replaces the scene's world and its sun."""
    _set_sun(scene, lighting)
    if scene.world is not None:
        bpy.data.worlds.remove(scene.world)
    world = bpy.data.worlds.new("sky")
    scene.world = world
    # Cycles would sample the sky's nodes at its full size to find bright spots; there are none but the sun.
    world.cycles.sampling_method = "MANUAL"
    world.cycles.sample_map_resolution = SKY_MAP_PX
    world.use_nodes = True
    tree = world.node_tree
    background = tree.nodes["Background"]
    tree.links.new(_sky_colour(tree, lighting), background.inputs["Color"])
    background.inputs["Strength"].default_value = 1.0


def _set_sun(scene: bpy.types.Scene, lighting: Lighting) -> None:
    for old in [item for item in scene.objects if item.type == "LIGHT"]:
        data = old.data
        bpy.data.objects.remove(old)
        bpy.data.lights.remove(data)
    if not lighting.is_sunny:
        return
    lamp = bpy.data.lights.new("sun", "SUN")
    strength = float(lighting.sun_colour.max())
    # A white surface that faces the sun sends out its irradiance over pi.
    lamp.energy = strength * math.pi
    lamp.color = tuple(lighting.sun_colour / strength)
    lamp.angle = SUN_ANGLE_RAD
    sun = bpy.data.objects.new("sun", lamp)
    sun.rotation_mode = "QUATERNION"
    sun.rotation_quaternion = mathutils.Vector(lighting.sun_direction).to_track_quat("Z", "Y")
    scene.collection.objects.link(sun)


def _sky_colour(tree: bpy.types.NodeTree, lighting: Lighting):
    """From the ground's colour through the horizon's to the zenith's, with clouds over it."""
    direction = tree.nodes.new("ShaderNodeTexCoord").outputs["Generated"]
    split = tree.nodes.new("ShaderNodeSeparateXYZ")
    tree.links.new(direction, split.inputs[0])
    ramp = tree.nodes.new("ShaderNodeValToRGB")
    height = tree.nodes.new("ShaderNodeMapRange")
    height.inputs["From Min"].default_value = -1.0
    tree.links.new(split.outputs["Z"], height.inputs["Value"])
    tree.links.new(height.outputs["Result"], ramp.inputs["Fac"])
    uniforms = lighting.uniforms
    stops = (
        ("ground_colour", 0.0),
        ("ground_colour", 0.485),
        ("horizon_colour", 0.502),
        ("zenith_colour", 1.0),
    )
    while len(ramp.color_ramp.elements) < len(stops):
        ramp.color_ramp.elements.new(0.5)
    for element, (name, position) in zip(ramp.color_ramp.elements, stops, strict=True):
        element.position = position
        element.color = (*uniforms[name], 1.0)
    mix = tree.nodes.new("ShaderNodeMixRGB")
    clouds = _cloud_share(tree, direction, split.outputs["Z"], float(uniforms["cloud_cover"]))
    tree.links.new(clouds, mix.inputs["Fac"])
    tree.links.new(ramp.outputs["Color"], mix.inputs["Color1"])
    mix.inputs["Color2"].default_value = (*uniforms["cloud_colour"], 1.0)
    return mix.outputs["Color"]


def _cloud_share(tree: bpy.types.NodeTree, direction, height, cover: float):
    """0 to 1: denser noise is cloud; none at the horizon, where the eye looks through haze."""
    noise = tree.nodes.new("ShaderNodeTexNoise")
    noise.inputs["Scale"].default_value = CLOUD_SCALE
    noise.inputs["Detail"].default_value = 8.0
    stretched = tree.nodes.new("ShaderNodeVectorMath")
    stretched.operation = "MULTIPLY"
    stretched.inputs[1].default_value = (1.0, 1.0, 2.5)
    tree.links.new(direction, stretched.inputs[0])
    tree.links.new(stretched.outputs[0], noise.inputs["Vector"])
    dense = tree.nodes.new("ShaderNodeMapRange")
    threshold = 0.75 - 0.4 * min(cover, 1.0)
    dense.inputs["From Min"].default_value = threshold
    dense.inputs["From Max"].default_value = threshold + 0.2
    tree.links.new(noise.outputs["Fac"], dense.inputs["Value"])
    fade = tree.nodes.new("ShaderNodeMapRange")
    fade.inputs["From Max"].default_value = 0.2
    tree.links.new(height, fade.inputs["Value"])
    share = tree.nodes.new("ShaderNodeMath")
    share.operation = "MULTIPLY"
    tree.links.new(dense.outputs["Result"], share.inputs[0])
    tree.links.new(fade.outputs["Result"], share.inputs[1])
    return share.outputs[0]
