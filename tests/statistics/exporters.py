# Run by Blender: blender -b --python exporters.py -- FOLDER. Models made of Blender's primitives by what people do to
# them, each exported to every format that `validate` reads. None of the mistakes in them is ours.
import math
import random
import sys

import bpy

folder = sys.argv[sys.argv.index("--") + 1]
mesh = bpy.ops.mesh
primitives = {
    "cube": mesh.primitive_cube_add,
    "sphere": mesh.primitive_uv_sphere_add,
    "sphere8": lambda: mesh.primitive_uv_sphere_add(segments=8, ring_count=5),
    "ico": mesh.primitive_ico_sphere_add,
    "ico1": lambda: mesh.primitive_ico_sphere_add(subdivisions=1),
    "cylinder": mesh.primitive_cylinder_add,
    "cylinder6": lambda: mesh.primitive_cylinder_add(vertices=6),
    "cone": mesh.primitive_cone_add,
    "frustum": lambda: mesh.primitive_cone_add(radius2=0.4),
    "torus": mesh.primitive_torus_add,
    "torus8": lambda: mesh.primitive_torus_add(major_segments=8, minor_segments=5),
    "monkey": mesh.primitive_monkey_add,
    "grid": mesh.primitive_grid_add,
    "disk": lambda: mesh.primitive_circle_add(fill_type="NGON"),
    "plane": mesh.primitive_plane_add,
}


def export(name):
    path = folder + "/" + name
    for write in (
        lambda: bpy.ops.export_scene.gltf(filepath=path + ".glb", export_format="GLB", export_tangents=True),
        lambda: bpy.ops.export_scene.gltf(
            filepath=path + ".applied.glb", export_format="GLB", export_tangents=True, export_apply=True
        ),
        lambda: bpy.ops.export_scene.fbx(filepath=path + ".fbx", use_tspace=True, mesh_smooth_type="FACE"),
        lambda: bpy.ops.wm.obj_export(filepath=path + ".obj"),
        lambda: bpy.ops.export_mesh.ply(filepath=path + ".ply"),
        lambda: bpy.ops.wm.collada_export(filepath=path + ".dae"),
    ):
        try:
            write()
        except RuntimeError:  # tangents of polygons with more than four sides
            pass


# A smooth object whose material reads a normal map.
def make(primitive, smooth=True):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    primitives[primitive]()
    made = bpy.context.object
    for polygon in made.data.polygons:
        polygon.use_smooth = smooth
    material = bpy.data.materials.new("material")
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    texture, normal = nodes.new("ShaderNodeTexImage"), nodes.new("ShaderNodeNormalMap")
    texture.image = bpy.data.images.new("normals", 8, 8)
    links.new(texture.outputs[0], normal.inputs[1])
    links.new(normal.outputs[0], nodes["Principled BSDF"].inputs["Normal"])
    made.data.materials.append(material)
    return made


def edited(operation):
    def change(_):
        bpy.ops.object.mode_set(mode="EDIT")
        mesh.select_all(action="SELECT")
        operation()
        bpy.ops.object.mode_set(mode="OBJECT")

    return change


def modified(kind, **settings):
    def change(made):
        modifier = made.modifiers.new(kind, kind)
        for name, value in settings.items():
            setattr(modifier, name, value)

    return change


def placed(scale, apply=False):
    def change(made):
        made.scale = scale
        made.rotation_euler = (0.3, 0.2, 0.5)
        if apply:
            bpy.ops.object.transform_apply()

    return change


def mapped(uv):
    def change(made):
        for loop in made.data.uv_layers.active.data:
            loop.uv = uv(*loop.uv)

    return change


def automatic(made):
    made.data.use_auto_smooth = True


def every_other(made):
    for k, polygon in enumerate(made.data.polygons):
        polygon.use_smooth = k % 2 == 0


def weighted(made):
    automatic(made)
    modified("BEVEL")(made)
    modified("WEIGHTED_NORMAL")(made)


def displaced(made):
    modified("DISPLACE", texture=bpy.data.textures.new("clouds", "CLOUDS"), strength=0.3)(made)


changes = {
    "smooth": lambda made: None,
    "auto": automatic,
    "half": every_other,
    "scaled": placed((1, 2, 0.3)),
    "squashed": placed((3, 1, 0.2), True),
    "mirrored": placed((-1, 1, 1)),
    "tiny": placed((0.001,) * 3, True),
    "huge": placed((1000,) * 3, True),
    "tiled": mapped(lambda u, v: (5 * u - 2, 3 * v + 7)),
    "flipped": mapped(lambda u, v: (1 - u, v)),
    "swapped": mapped(lambda u, v: (v, u)),
    "smart": edited(lambda: bpy.ops.uv.smart_project()),
    "unwrapped": edited(lambda: bpy.ops.uv.unwrap()),
    "projected": edited(lambda: bpy.ops.uv.cube_project()),
    "lightmap": edited(lambda: bpy.ops.uv.lightmap_pack(PREF_CONTEXT="ALL_FACES")),
    "triangles": edited(lambda: mesh.quads_convert_to_tris(quad_method="BEAUTY")),
    "alternate": edited(lambda: mesh.quads_convert_to_tris(quad_method="FIXED_ALTERNATE")),
    "fractal": edited(lambda: mesh.subdivide(number_cuts=2, smoothness=0.3, fractal=0.4)),
    "inside": edited(lambda: mesh.flip_normals()),
    "dissolved": edited(lambda: mesh.dissolve_limited(angle_limit=0.6)),
    "bevelled": modified("BEVEL"),
    "weighted": weighted,
    "subdivided": modified("SUBSURF"),
    "thick": modified("SOLIDIFY"),
    "symmetric": modified("MIRROR"),
    "repeated": modified("ARRAY"),
    "wire": modified("WIREFRAME"),
    "remeshed": modified("REMESH"),
    "decimated": modified("DECIMATE", ratio=0.4),
    "planar": modified("DECIMATE", decimate_type="DISSOLVE", angle_limit=0.3),
    "displaced": displaced,
    "twisted": modified("SIMPLE_DEFORM", deform_method="TWIST", angle=1.5),
    "relaxed": modified("SMOOTH", iterations=10),
    "split": modified("EDGE_SPLIT"),
}

random.seed(1)
for name in primitives:
    make(name, smooth=False)
    export(name + "_flat")
    for change in changes:
        changes[change](make(name))
        export(name + "_" + change)
