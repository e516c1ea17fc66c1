"""Renders volumes side by side with Cycles, by one camera and one light.

blender -b --factory-startup --python render.py -- OUT.png VOLUME.vdb... [--from x|y|z] [--samples N] [--density D] [--height PIXELS]

Smoke is grey, `flame` glows. All pictures show the box around all volumes, and a tenth more.
"""

import argparse
import os
import sys
import tempfile

import bpy
import numpy as np
from mathutils import Vector


def main():
    parser = argparse.ArgumentParser(prog="render.py")
    parser.add_argument("out")
    parser.add_argument("volumes", nargs="+")
    parser.add_argument("--from", dest="side", choices="xyz", default="y")
    parser.add_argument("--samples", type=int, default=48)
    parser.add_argument("--density", type=float, default=25)
    parser.add_argument("--height", type=int, default=512)
    asked = parser.parse_args(sys.argv[sys.argv.index("--") + 1:])
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples = asked.samples
    scene.cycles.seed = 1
    scene.cycles.volume_bounces = 4
    scene.cycles.use_denoising = False
    scene.cycles.volume_max_steps = 256
    scene.view_settings.view_transform = "Standard"
    volumes = [volume_of(path, asked.density) for path in asked.volumes]
    place_camera(volumes, asked.side, asked.height)
    light(asked.side)
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for shown in volumes:
            for each in volumes:
                each.hide_render = each is not shown
            scene.render.filepath = os.path.join(folder, "picture.png")
            bpy.ops.render.render(write_still=True)
            rows.append(pixels_of(scene.render.filepath))
    save(np.concatenate(rows, axis=1), asked.out)


def volume_of(path, density):
    data = bpy.data.volumes.new(os.path.basename(path))
    data.filepath = os.path.abspath(path)
    out = bpy.data.objects.new(data.name, data)
    bpy.context.scene.collection.objects.link(out)
    data.grids.load()
    names = [grid.name for grid in data.grids]
    material = bpy.data.materials.new(data.name)
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    smoke, surface = nodes.new("ShaderNodeVolumePrincipled"), nodes.new("ShaderNodeOutputMaterial")
    smoke.inputs["Density"].default_value = density
    smoke.inputs["Density Attribute"].default_value = "density" if "density" in names else names[0]
    smoke.inputs["Color"].default_value = (0.85, 0.87, 0.9, 1)
    smoke.inputs["Anisotropy"].default_value = 0.2
    if "flame" in names:
        flame, strength = nodes.new("ShaderNodeAttribute"), nodes.new("ShaderNodeMath")
        flame.attribute_name = "flame"
        strength.operation = "MULTIPLY"
        strength.inputs[1].default_value = density / 6
        links.new(flame.outputs["Fac"], strength.inputs[0])
        links.new(strength.outputs[0], smoke.inputs["Emission Strength"])
        smoke.inputs["Emission Color"].default_value = (1, 0.33, 0.07, 1)
    links.new(smoke.outputs[0], surface.inputs["Volume"])
    data.materials.append(material)
    return out


def place_camera(volumes, side, height):
    """Looks along an axis, without perspective, at the box around all volumes."""
    bpy.context.view_layer.update()
    corners = [volume.matrix_world @ Vector(each) for volume in volumes for each in volume.bound_box]
    low = Vector([min(each[n] for each in corners) for n in range(3)])
    high = Vector([max(each[n] for each in corners) for n in range(3)])
    middle, size = (low + high) / 2, high - low
    camera = bpy.data.cameras.new("camera")
    camera.type = "ORTHO"
    camera.clip_end = 1000
    out = bpy.data.objects.new("camera", camera)
    bpy.context.scene.collection.objects.link(out)
    bpy.context.scene.camera = out
    directions = {"x": (Vector((1, 0, 0)), size.y, size.z), "y": (Vector((0, -1, 0)), size.x, size.z), "z": (Vector((0, 0, 1)), size.x, size.y)}
    direction, width, tall = directions[side]
    out.location = middle + direction * (size.length + 1)
    out.rotation_euler = (-direction).to_track_quat("-Z", "Y").to_euler()
    if side == "z":
        out.rotation_euler = (0, 0, 0)
    width, tall = 1.1 * width, 1.1 * tall
    camera.ortho_scale = max(width, tall)
    render = bpy.context.scene.render
    render.resolution_y = height
    render.resolution_x = max(16, round(height * width / tall))


def light(side):
    sun = bpy.data.lights.new("sun", "SUN")
    sun.energy = 6
    sun.angle = 0.05
    out = bpy.data.objects.new("sun", sun)
    bpy.context.scene.collection.objects.link(out)
    out.rotation_euler = (0.9, 0, 0.9) if side != "z" else (0.8, 0.5, 0)
    world = bpy.data.worlds.new("world")
    bpy.context.scene.world = world
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs[0].default_value = (0.02, 0.025, 0.035, 1)


def pixels_of(path):
    image = bpy.data.images.load(path)
    out = np.array(image.pixels[:], np.float32).reshape(image.size[1], image.size[0], 4)
    bpy.data.images.remove(image)
    return out


def save(pixels, path):
    image = bpy.data.images.new("out", pixels.shape[1], pixels.shape[0])
    image.pixels = pixels.ravel()
    image.filepath_raw = os.path.abspath(path)
    image.file_format = "PNG"
    image.save()


main()
