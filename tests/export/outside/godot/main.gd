# Draws res://model.glb, as the editor has imported it, into picture.png, and tells what it is.
extends Spatial

var box = AABB()
var triangles = 0
var surfaces = 0

func look_at_meshes(node):
	if node is MeshInstance:
		var here = node.global_transform.xform(node.get_aabb())
		box = here if triangles == 0 else box.merge(here)
		triangles += node.mesh.get_faces().size() / 3
		surfaces += node.mesh.get_surface_count()
	for child in node.get_children():
		look_at_meshes(child)

func _ready():
	var model = load("res://model.glb").instance()
	add_child(model)
	look_at_meshes(model)
	var radius = box.size.length() / 2
	var centre = box.position + box.size / 2
	var camera = Camera.new()
	add_child(camera)
	camera.fov = 45
	camera.near = radius / 50
	camera.far = radius * 10
	var away = Vector3(0.5, 0.4, 1).normalized()
	camera.look_at_from_position(centre + away * 1.1 * radius / tan(PI / 8), centre, Vector3.UP)
	camera.make_current()
	var sun = DirectionalLight.new()
	add_child(sun)
	sun.look_at_from_position(centre + Vector3(-1, 2, 2), centre, Vector3.UP)
	var world = WorldEnvironment.new()
	world.environment = Environment.new()
	world.environment.ambient_light_color = Color(0.5, 0.5, 0.5)
	world.environment.background_mode = Environment.BG_COLOR
	world.environment.background_color = Color(0.85, 0.85, 0.88)
	add_child(world)
	for i in range(3):
		yield(get_tree(), "idle_frame")
	yield(VisualServer, "frame_post_draw")
	var picture = get_viewport().get_texture().get_data()
	picture.flip_y()
	picture.save_png("picture.png")
	print("made: ", triangles, " triangles, ", surfaces, " surfaces")
	get_tree().quit()
