# SPDX-License-Identifier: GPL-3.0-or-later
# Moves a character that was exported with the layout "rigged" live, in Godot 4: joint points in, poses of the skeleton and weights of blend shapes out,
# by the steps of Imomushi's own frame (core/export/driver.h describes the data; eq. (5) of Watanabe et al., FIT 2006).
#
#   var driver := ImomushiDriver.new($Caterpillar, "res://caterpillar.glb")
#   driver.move_point("head-bone/end", Vector3(1.0, 1.0, 0.25))   # as often as you like
#   driver.update()                                               # once per frame
class_name ImomushiDriver
extends RefCounted

var data: Dictionary
var points: Array[Vector3] = []
var rolls: Array[float] = []
var rotations: Array[Quaternion] = []
var skeleton: Skeleton3D
var bodies := {}  # index of an element -> MeshInstance3D


func _init(scene: Node, path: String) -> void:
	var file := FileAccess.open(path, FileAccess.READ)
	file.seek(12)
	var size := file.get_32()
	file.seek(20)
	var gltf: Dictionary = JSON.parse_string(file.get_buffer(size).get_string_from_utf8())
	for node in gltf["nodes"]:
		if node.get("extras", {}).has("imomushi"):
			data = node["extras"]["imomushi"]
	assert(not data.is_empty(), "The file was not exported with the layout \"rigged\".")
	skeleton = scene.find_children("*", "Skeleton3D", true, false)[0]
	for body in scene.find_children("*", "MeshInstance3D", true, false):
		for e in data["elements"].size():
			if body.name == String(data["elements"][e]["name"]).validate_node_name():
				bodies[e] = body
	rest()


## The rest pose.
func rest() -> void:
	points.assign(data["points"].map(func(p): return _vector(p["rest"])))
	rolls.assign(data["points"].map(func(_p): return 0.0))
	rotations.assign(data["bones"].map(func(_b): return Quaternion.IDENTITY))


## Moves a joint point ("bone/end") to a place (m), turned by `roll` (radians) about its bone.
func move_point(name: String, to: Vector3, roll := NAN) -> void:
	for p in points.size():
		if data["points"][p]["name"] == name:
			points[p] = to
			if not is_nan(roll):
				rolls[p] = roll


## Poses the skeleton and weighs the blend shapes.
func update() -> void:
	_transport()
	var frames := []
	for element in data["elements"]:
		frames.append(_place_element(element))
	var joints := []
	for joint in data["joints"]:
		joints.append(_place_joint(joint, frames))
	for e in data["elements"].size():
		var element: Dictionary = data["elements"][e]
		var frame: Transform3D = frames[e]
		var bone := skeleton.find_bone(element["frame"])
		if bone >= 0:
			skeleton.set_bone_pose_position(bone, frame * _vector(element["middle"]))
			skeleton.set_bone_pose_rotation(bone, frame.basis.get_rotation_quaternion())
		if bodies.has(e):
			var weights := _weigh(element, frame, joints)
			for t in weights.size():
				bodies[e].set_blend_shape_value(t, weights[t])


static func _vector(a: Array, at := 0) -> Vector3:
	return Vector3(a[at], a[at + 1], a[at + 2])


static func _basis(a: Array) -> Basis:
	return Basis(_vector(a, 0), _vector(a, 3), _vector(a, 6))


static func _least(from: Vector3, to: Vector3) -> Quaternion:
	var w := 1.0 + from.dot(to)
	if w < 1e-6:
		var side := from.cross(Vector3.RIGHT if absf(from.x) < 0.6 else Vector3.UP).normalized()
		return Quaternion(side.x, side.y, side.z, 0.0)
	var axis := from.cross(to)
	return Quaternion(axis.x, axis.y, axis.z, w).normalized()


static func _bounded(x: float) -> float:
	var room := 0.7 if x < 0.0 else 2.0
	return 1.0 + room * tanh(x / room)


## Weighted mean of [rotation, weight, tree]; signs across trees of bones are aligned with the first.
static func _mean(given: Array) -> Quaternion:
	var sum := Vector4.ZERO
	for one in given:
		var q: Quaternion = one[0]
		var v := Vector4(q.x, q.y, q.z, q.w)
		var turned: float = -1.0 if one[2] != given[0][2] and sum.dot(v) < 0.0 else 1.0
		sum += turned * one[1] * v
	if sum.length() < 1e-6:
		return given[0][0]
	sum = sum.normalized()
	return Quaternion(sum.x, sum.y, sum.z, sum.w)


# Each bone hangs on its parent's by the least rotation.
func _transport() -> void:
	for b in data["bones"].size():
		var bone: Dictionary = data["bones"][b]
		var along := points[bone["end"]] - points[bone["start"]]
		if along.length() <= 1e-6 * bone["length"]:
			continue
		var base := rotations[b] if bone["parent"] < 0 else rotations[bone["parent"]]
		rotations[b] = (_least((base * _vector(bone["direction"])).normalized(), along.normalized()) * base).normalized()


func _place_element(element: Dictionary) -> Transform3D:
	if element["bones"].is_empty():
		return Transform3D.IDENTITY
	var anchor := Vector3.ZERO
	var given := []
	for b in element["bones"]:
		var bone: Dictionary = data["bones"][b]
		anchor += 0.5 * bone["length"] / element["boneLength"] * (points[bone["start"]] + points[bone["end"]])
		var roll: float = bone["rollSign"] * 0.5 * (rolls[bone["start"]] + rolls[bone["end"]])
		var q := rotations[b]
		given.append([Quaternion((q * _vector(bone["direction"])).normalized(), roll) * q, bone["length"], bone["tree"]])
	if element["anchorJoint"] >= 0:
		anchor = points[data["joints"][element["anchorJoint"]]["point"]]
	var turned := Basis(_mean(given))
	return Transform3D(turned, anchor - turned * _vector(element["anchor"]))


## x -> basis * x + origin of a joint, rest to world.
func _place_joint(joint: Dictionary, frames: Array) -> Transform3D:
	var place := _vector(joint["place"])
	var carried := Vector3.ZERO
	var given := []
	for f in joint["faces"]:
		var frame: Transform3D = frames[f["element"]]
		carried += frame * place / joint["faces"].size()
		var tree: float = data["bones"][f["bone"]]["tree"] if f["bone"] >= 0 else -1.0 - f["element"]
		if joint["led"]:
			if f["leads"]:
				given.append([frame.basis.get_rotation_quaternion(), 1.0, tree])
		elif f["bone"] >= 0 and joint["point"] >= 0:
			given.append([rotations[f["bone"]], 1.0, tree])
		else:
			given.append([frame.basis.get_rotation_quaternion(), 1.0, -1.0 - f["element"]])
	var at := points[joint["point"]] if joint["point"] >= 0 else carried
	var outward := 0.0
	var shifted := 0
	for f in joint["faces"]:
		if f["bone"] < 0:
			continue
		var frame: Transform3D = frames[f["element"]]
		var normal := _vector(data["elements"][f["element"]]["faces"][f["face"]]["axes"], 6)
		outward += (frame.basis * normal).dot(at - frame * place)
		shifted += 1
	var rotation := _mean(given)
	var tangent := _vector(joint["tangent"])
	if not joint["led"] and joint["point"] >= 0 and rolls[joint["point"]] != 0.0 and tangent.length() > 0.0:
		rotation = Quaternion((rotation * tangent).normalized(), rolls[joint["point"]]) * rotation
	var stretch := _bounded(joint["shrink"] * outward / shifted) if shifted > 0 else 1.0
	var n := _vector(joint["normal"])
	var across := Basis(n * n.x, n * n.y, n * n.z)
	var swollen := Basis()
	for c in 3:
		swollen[c] = stretch * Basis.IDENTITY[c] + (1.0 - stretch) * across[c]
	var linear := Basis(rotation) * swollen
	return Transform3D(linear, at - linear * place)


## Weights of the blend shapes: v of eq. (5), in the frame of the element, times the matrix of the file.
func _weigh(element: Dictionary, frame: Transform3D, joints: Array) -> Array[float]:
	var columns := int(element["columns"])
	var v: Array[float] = []
	v.resize(columns)
	v.fill(0.0)
	for face in element["faces"]:
		if not face.has("column"):
			continue
		var joint: Transform3D = joints[face["joint"]]
		var axes := _basis(face["axes"])
		var to_face := axes.transposed() * frame.basis.transposed()
		var l := to_face * joint.basis * axes
		var origin := _vector(face["origin"])
		var shift := to_face * (joint * origin - frame * origin)
		if face["basis"] == "paper":
			# Without the twist that the basis cannot say.
			var twist := atan2(l.x.y - l.y.x, l.x.x + l.y.y)
			var x := cos(twist) * l.x - sin(twist) * l.y
			var y := sin(twist) * l.x + cos(twist) * l.y
			l = Basis(x, y, l.z)
		var said: Array[float] = [l.x.x - 1.0, 0.5 * (l.y.x + l.x.y), l.y.y - 1.0, l.x.z, l.y.z, shift.z]
		if face["basis"] != "paper":
			said.append_array([shift.x, shift.y, 0.5 * (l.x.y - l.y.x)])
		if not face["flat"]:
			said.append_array([l.z.x, l.z.y, l.z.z - 1.0])
		for i in said.size():
			v[int(face["column"]) + i] = said[i]
	var weights: Array[float] = []
	for t in element["matrix"].size() / maxi(columns, 1):
		var sum := 0.0
		for c in columns:
			sum += v[c] * element["matrix"][t * columns + c]
		weights.append(sum)
	return weights
