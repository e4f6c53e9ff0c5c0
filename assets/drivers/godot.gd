# SPDX-License-Identifier: GPL-3.0-or-later
# Moves a character that was exported with the layout "rigged" live, in Godot 4: joint points in, poses of the skeleton and weights of blend shapes out,
# by the steps of Imomushi's own frame (core/export/driver.h describes the data; eq. (5) of Watanabe et al., FIT 2006). Smooth joints, gravity and inflation act
# as in a body at rest; what moves by itself, large motions, fingers and joints of the previous model do not.
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
var parts := {}  # index of a part of a character -> MeshInstance3D
# Smooth joints: numbers of a joint's table, unknowns in all, and where those of each joint begin (-1: it has none).
var entries := 0
var unknowns := 0
var first := []
# Per element: its stiffness between the tables of its joints, and forces on these by v; empty: it has none.
var links := []


func _init(scene: Node, path: String) -> void:
	var file := FileAccess.open(path, FileAccess.READ)
	file.seek(12)
	var size := file.get_32()
	file.seek(20)
	var gltf: Dictionary = JSON.parse_string(file.get_buffer(size).get_string_from_utf8())
	var part_names := {}
	for node in gltf["nodes"]:
		if node.get("extras", {}).has("imomushi"):
			data = node["extras"]["imomushi"]
		if node.get("extras", {}).has("part"):
			part_names[String(node["name"]).validate_node_name()] = int(node["extras"]["part"])
	assert(not data.is_empty(), "The file was not exported with the layout \"rigged\".")
	skeleton = scene.find_children("*", "Skeleton3D", true, false)[0]
	for body in scene.find_children("*", "MeshInstance3D", true, false):
		if part_names.has(String(body.name)):
			parts[part_names[String(body.name)]] = body
			continue
		for e in data["elements"].size():
			if body.name == String(data["elements"][e]["name"]).validate_node_name():
				bodies[e] = body
	if data.has("smooth"):
		_prepare_smooth()
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
	var values := []
	for e in data["elements"].size():
		values.append(_measure(data["elements"][e], frames[e], joints))
	if data.has("smooth"):
		_relax(frames, joints, values)
	var of_parts := {}  # elements with the same targets add up
	for e in data["elements"].size():
		var element: Dictionary = data["elements"][e]
		var frame: Transform3D = frames[e]
		var bone := skeleton.find_bone(element["frame"])
		if bone >= 0:
			skeleton.set_bone_pose_position(bone, frame * _vector(element["middle"]))
			skeleton.set_bone_pose_rotation(bone, frame.basis.get_rotation_quaternion())
		if bodies.has(e):
			var weights := _weigh(element, values[e])
			for t in weights.size():
				bodies[e].set_blend_shape_value(t, weights[t])
		for moved in element.get("parts", []):
			var weights := _weigh(element, values[e])
			var part := int(moved[0])
			if not of_parts.has(part):
				of_parts[part] = {}
			var all: Dictionary = of_parts[part]
			for t in weights.size():
				all[int(moved[1]) + t] = all.get(int(moved[1]) + t, 0.0) + weights[t]
	for part in of_parts:
		for t in of_parts[part]:
			if parts.has(part):
				parts[part].set_blend_shape_value(t, of_parts[part][t])


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
	if data.has("smooth"):
		var turned := Basis(rotation)
		return Transform3D(turned, at - turned * place)
	var stretch := _bounded(joint["shrink"] * outward / shifted) if shifted > 0 else 1.0
	var n := _vector(joint["normal"])
	var across := Basis(n * n.x, n * n.y, n * n.z)
	var swollen := Basis()
	for c in 3:
		swollen[c] = stretch * Basis.IDENTITY[c] + (1.0 - stretch) * across[c]
	var linear := Basis(rotation) * swollen
	return Transform3D(linear, at - linear * place)


## v of eq. (5) in the frame of the element, and what body loads do.
func _measure(element: Dictionary, frame: Transform3D, joints: Array) -> Array[float]:
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
			l = _untwisted(l)
		var said: Array[float] = [l.x.x - 1.0, 0.5 * (l.y.x + l.x.y), l.y.y - 1.0, l.x.z, l.y.z, shift.z]
		if face["basis"] != "paper":
			said.append_array([shift.x, shift.y, 0.5 * (l.x.y - l.y.x)])
		if not face["flat"]:
			said.append_array([l.z.x, l.z.y, l.z.z - 1.0])
		for i in said.size():
			v[int(face["column"]) + i] = said[i]
	if element.has("loads"):
		var loads: Dictionary = element["loads"]
		var all: Array[float] = []
		if loads.has("softness"):
			var pull: Vector3 = loads["softness"] * (frame.basis.transposed() * _vector(data["gravity"]))
			all.append_array([pull.x, pull.y, pull.z])
		if loads.has("pressure"):
			all.append(loads["pressure"])
		var wanted := 0.0
		for i in all.size():
			wanted += absf(all[i]) * loads["sizes"][i]
		var part: float = loads["most"] * tanh(wanted / loads["most"]) / wanted if wanted > 0.0 else 0.0
		for i in all.size():
			v[int(loads["column"]) + i] = part * all[i]
		if loads.has("stretch"):
			var stretch: Dictionary = loads["stretch"]
			var rest: float = stretch["length"]
			var along: Vector3 = frame.basis.transposed() * (points[int(stretch["end"])] - points[int(stretch["near"])])
			var now := along.length()
			var room: float = rest * (stretch["shorter"] if now < rest else stretch["longer"])
			if now > 0.0:
				var pull: Vector3 = room * tanh((now - rest) / room) / now * (_basis(stretch["perMetre"]) * along)
				for i in 3:
					v[int(loads["column"]) + i] += pull[i]
	return v


## Without the twist that the basis of the paper cannot say.
static func _untwisted(l: Basis) -> Basis:
	var twist := atan2(l.x.y - l.y.x, l.x.x + l.y.y)
	var x := cos(twist) * l.x - sin(twist) * l.y
	var y := sin(twist) * l.x + cos(twist) * l.y
	return Basis(x, y, l.z)


static func _zeros(count: int) -> Array[float]:
	var out: Array[float] = []
	out.resize(count)
	out.fill(0.0)
	return out


# What is the same in all frames.
func _prepare_smooth() -> void:
	entries = data["smooth"]["entries"].size()
	var free := []
	for joint in data["joints"]:
		free.append(false)
	for element in data["elements"]:
		var link := []
		links.append(link)
		if not element.has("stiffness"):
			continue
		var columns := int(sqrt(element["stiffness"].size()) + 0.5)
		for face in element["faces"]:
			free[int(face["joint"])] = true
			var count := int(face["spread"].size() / entries)
			var pull := _zeros(entries * columns)
			for i in count:
				for a in entries:
					var share: float = face["spread"][i * entries + a]
					if share == 0.0:
						continue
					for c in columns:
						pull[a * columns + c] += share * element["stiffness"][(int(face["column"]) + i) * columns + c]
			var between := []
			for g in link.size() + 1:
				var other: Dictionary = element["faces"][g]
				var block := _zeros(entries * entries)
				for k in int(other["spread"].size() / entries):
					for a in entries:
						var along: float = pull[a * columns + int(other["column"]) + k]
						for b in entries:
							block[a * entries + b] += along * other["spread"][k * entries + b]
				between.append(block)
			link.append([pull, between, columns, count])
	for is_free in free:
		first.append(unknowns if is_free else -1)
		if is_free:
			unknowns += int(data["smooth"]["parameters"])


# The shapes of all joints that balance their elements: v of rigid joints becomes v of these.
func _relax(frames: Array, joints: Array, values: Array) -> void:
	var smooth: Dictionary = data["smooth"]
	var parameters := int(smooth["parameters"])
	var m := _zeros(unknowns * unknowns)
	var right := _zeros(unknowns)
	var turns := []
	for e in data["elements"].size():
		var element: Dictionary = data["elements"][e]
		var turned := []
		turns.append(turned)
		for i in links[e].size():
			var face: Dictionary = element["faces"][i]
			var to_face := _basis(face["axes"]).transposed()
			var t: Basis = to_face * frames[e].basis.transposed() * joints[int(face["joint"])].basis * _basis(face["axes"])
			if face["basis"] == "paper":
				t = _untwisted(t)
			turned.append(t * to_face * _basis(data["joints"][int(face["joint"])]["axes"]))
		for i in links[e].size():
			_add_force(element, links[e][i], element["faces"][i], turned[i], values[e], right)
			for j in i + 1:
				_add_stiffness(links[e][i][1][j], turned[i], turned[j], first[int(element["faces"][i]["joint"])], first[int(element["faces"][j]["joint"])], i != j, m)
	for from in first:
		if from < 0:
			continue
		var most := 0.0
		for i in parameters:
			most = maxf(most, m[(from + i) * unknowns + from + i])
		for i in parameters:
			m[(from + i) * unknowns + from + i] += smooth["leastStiffness"] * most if most > 0.0 else 1.0
	_solve(m, right)
	var tables := []
	for j in first.size():
		tables.append(_table(data["joints"][j], right, first[j]) if first[j] >= 0 else [])
	for e in data["elements"].size():
		for i in links[e].size():
			var face: Dictionary = data["elements"][e]["faces"][i]
			for a in entries / 3:
				var along: Vector3 = turns[e][i] * _vector(tables[int(face["joint"])], 3 * a)
				for k in links[e][i][3]:
					var row: int = k * entries + 3 * a
					values[e][int(face["column"]) + k] += face["spread"][row] * along.x + face["spread"][row + 1] * along.y + face["spread"][row + 2] * along.z


func _add_force(element: Dictionary, link: Array, face: Dictionary, turn: Basis, v: Array, right: Array) -> void:
	var at: int = first[int(face["joint"])]
	var columns: int = link[2]
	var force := _zeros(entries)
	for a in entries:
		for c in columns:
			force[a] += link[0][a * columns + c] * v[c]
	if element.has("loads") and element["loads"].has("forces"):
		var loads: Dictionary = element["loads"]
		var count: int = loads["sizes"].size()
		for k in link[3]:
			var held := 0.0
			for l in count:
				held += loads["forces"][(int(face["column"]) + k) * count + l] * v[int(loads["column"]) + l]
			for a in entries:
				force[a] += face["spread"][k * entries + a] * held
	for a in entries / 3:
		var pull := turn.transposed() * _vector(force, 3 * a)
		var along := [pull.x, pull.y, pull.z]
		for d in 3:
			for entry in data["smooth"]["entries"][3 * a + d]:
				right[at + int(entry[0])] -= entry[1] * along[d]


func _add_stiffness(between: Array, turn: Basis, other: Basis, at: int, to: int, twice: bool, m: Array) -> void:
	for a in entries / 3:
		for b in entries / 3:
			var from := 3 * a * entries + 3 * b
			var x := Vector3(between[from], between[from + entries], between[from + 2 * entries])
			var y := Vector3(between[from + 1], between[from + entries + 1], between[from + 2 * entries + 1])
			var z := Vector3(between[from + 2], between[from + entries + 2], between[from + 2 * entries + 2])
			var block := turn.transposed() * Basis(x, y, z) * other
			for q in 3:
				var along := [block[q].x, block[q].y, block[q].z]
				for column in data["smooth"]["entries"][3 * b + q]:
					for p in 3:
						for row in data["smooth"]["entries"][3 * a + p]:
							var part: float = row[1] * column[1] * along[p]
							m[(at + int(row[0])) * unknowns + to + int(column[0])] += part
							if twice:
								m[(to + int(column[0])) * unknowns + at + int(row[0])] += part


# Replaces `right` by x with m x = right, m symmetric and positive; m becomes its Cholesky factor.
func _solve(m: Array, right: Array) -> void:
	var n := unknowns
	for i in n:
		for j in i + 1:
			var sum: float = m[i * n + j]
			for k in j:
				sum -= m[i * n + k] * m[j * n + k]
			m[i * n + j] = sqrt(maxf(sum, 1e-300)) if i == j else sum / m[j * n + j]
	for i in n:
		for k in i:
			right[i] -= m[i * n + k] * right[k]
		right[i] /= m[i * n + i]
	for back in n:
		var i := n - 1 - back
		for k in back:
			right[i] -= m[(n - 1 - k) * n + i] * right[n - 1 - k]
		right[i] /= m[i * n + i]


# The table of a joint: what its free parameters say, within bounds.
func _table(joint: Dictionary, q: Array, at: int) -> Array:
	var smooth: Dictionary = data["smooth"]
	var table := _zeros(entries)
	var middle: float = 0.5 * (q[at] + q[at + 2])
	var half: float = 0.5 * (q[at] - q[at + 2])
	var radius := sqrt(half * half + q[at + 1] * q[at + 1])
	var most := _within(middle + radius)
	var least := _within(middle - radius)
	var turn := 0.5 * (most - least) / radius if radius > 0.0 else 0.0
	table[0] = 0.5 * (most + least) + turn * half
	table[1] = turn * q[at + 1]
	table[3] = table[1]
	table[4] = 0.5 * (most + least) - turn * half
	for i in entries - 6:
		for entry in smooth["entries"][6 + i]:
			table[6 + i] += entry[1] * q[at + int(entry[0])]
	var worst := 0.0
	var shapes := int(entries / 3) - 2
	for places in joint["slopes"]:
		var folded := 0.0
		var out := 0.0
		for axis in 2:
			var g := Vector3.ZERO
			for s in shapes:
				g += places[axis * shapes + s] * _vector(table, 6 + 3 * s)
			folded += g.x * g.x + g.y * g.y
			out += g.z * g.z
		worst = maxf(worst, folded / pow(smooth["fold"] * (1.0 + least), 2.0) + out / pow(smooth["slope"], 2.0))
	var part := _bound_factor(sqrt(worst), 1.0)
	for i in entries - 6:
		table[6 + i] *= part
	return table


func _within(x: float) -> float:
	var stretch: Array = data["smooth"]["stretch"]
	return x * _bound_factor(x, 1.0 - stretch[0] if x < 0.0 else stretch[1] - 1.0)


## x near 0, below `limit` everywhere: x times this.
static func _bound_factor(x: float, limit: float) -> float:
	return pow(1.0 + pow(x / limit, 6.0), -1.0 / 6.0)


## Weights of the blend shapes: v times the matrix of the file.
func _weigh(element: Dictionary, v: Array) -> Array[float]:
	var columns := int(element["columns"])
	var weights: Array[float] = []
	for t in element["matrix"].size() / maxi(columns, 1):
		var sum := 0.0
		for c in columns:
			sum += v[c] * element["matrix"][t * columns + c]
		weights.append(sum)
	return weights
