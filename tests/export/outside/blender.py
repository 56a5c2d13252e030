# An export in Blender: blender -b --factory-startup --python blender.py -- A.glb A.png
# Prints what the importer made of it, and renders it by Cycles.
import sys
from math import radians, tan

import bpy
import numpy
from mathutils import Vector

if not hasattr(numpy, 'bool'):  # Blender 3.4 beside a numpy of 1.24 or later
    numpy.bool = bool
glb, picture = sys.argv[sys.argv.index('--') + 1:]
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath=glb)
meshes = [o for o in bpy.context.scene.objects if o.type == 'MESH']
corners = [o.matrix_world @ Vector(c) for o in meshes for c in o.bound_box]
low = Vector(map(min, *corners))
high = Vector(map(max, *corners))
centre, radius = (low + high) / 2, (high - low).length / 2

scene = bpy.context.scene
camera = bpy.data.objects.new('camera', bpy.data.cameras.new('camera'))
camera.data.angle = radians(45)
away = Vector((0.5, -1, 0.4)).normalized()
camera.location = centre + away * radius * 1.1 / tan(radians(22.5))
camera.rotation_euler = away.to_track_quat('Z', 'Y').to_euler()
camera.data.clip_end = 100 * radius
camera.data.clip_start = radius / 100
light = bpy.data.objects.new('sun', bpy.data.lights.new('sun', 'SUN'))
light.data.energy = 3
light.rotation_euler = (radians(50), 0, radians(60))
for made in (camera, light):
    scene.collection.objects.link(made)
scene.camera = camera
scene.world = bpy.data.worlds.new('world')
scene.world.use_nodes = True
scene.world.node_tree.nodes['Background'].inputs[0].default_value = (0.3, 0.3, 0.35, 1)
scene.render.engine = 'CYCLES'
scene.cycles.samples = 16
scene.cycles.use_denoising = False
scene.render.resolution_x = scene.render.resolution_y = 480
scene.render.filepath = picture
bpy.ops.render.render(write_still=True)
print('made:', sum(len(o.data.polygons) for o in meshes), 'triangles,',
      len(bpy.data.materials), 'materials,', len([i for i in bpy.data.images if i.size[0]]), 'images')
