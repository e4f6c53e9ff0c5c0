// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/models/texts.h"

#include <QCoreApplication>
#include <QLocale>
#include <algorithm>
#include <cmath>
#include <map>

#include "ui/models/effect_texts.h"

namespace imomushi {
namespace {

struct Texts {
    Q_DECLARE_TR_FUNCTIONS(Texts)
};

QString named(const std::map<std::string, const char*>& table, const char* context, const std::string& key) {
    const auto found = table.find(key);
    return found == table.end() ? QString() : QCoreApplication::translate(context, found->second);
}

// In English the message of core is shown, which knows names and numbers; other languages show the sentence of the code.
const std::map<std::string, const char*> kErrors = {
    {"unknown-command", QT_TRANSLATE_NOOP("Errors", "There is no such command.")},
    {"unknown-key", QT_TRANSLATE_NOOP("Errors", "The command does not know one of its keys.")},
    {"missing-key", QT_TRANSLATE_NOOP("Errors", "A key of the command is missing.")},
    {"bad-type", QT_TRANSLATE_NOOP("Errors", "A value has the wrong type.")},
    {"bad-value", QT_TRANSLATE_NOOP("Errors", "This value is not allowed here.")},
    {"not-finite", QT_TRANSLATE_NOOP("Errors", "Only finite numbers are accepted.")},
    {"no-such-element", QT_TRANSLATE_NOOP("Errors", "There is no element of that name.")},
    {"no-such-face", QT_TRANSLATE_NOOP("Errors", "There is no joint face of that name.")},
    {"no-such-bone", QT_TRANSLATE_NOOP("Errors", "There is no bone of that name.")},
    {"name-taken", QT_TRANSLATE_NOOP("Errors", "This name is already taken. Choose another one.")},
    {"bad-name", QT_TRANSLATE_NOOP("Errors", "This name cannot be used. Choose another one.")},
    {"no-patch", QT_TRANSLATE_NOOP("Errors", "No flat patch of the surface lies there.")},
    {"bad-index", QT_TRANSLATE_NOOP("Errors", "A vertex does not exist.")},
    {"not-connected", QT_TRANSLATE_NOOP("Errors", "The patch falls into several pieces. Choose one connected patch.")},
    {"not-planar", QT_TRANSLATE_NOOP("Errors", "The patch is too far from flat for a joint face.")},
    {"nothing-to-drive", QT_TRANSLATE_NOOP("Errors", "There is nothing that could be driven so: the character needs bones whose ends are free, handles or shapes.")},
    {"no-devices", QT_TRANSLATE_NOOP("Errors", "Devices of this kind cannot be had on this machine: the system has no driver for them, or does not let this program have them.")},
    {"port-taken", QT_TRANSLATE_NOOP("Errors", "Another program uses this port. Close it, or choose another port here and in the sender.")},
    {"no-address", QT_TRANSLATE_NOOP("Errors", "This is no address. Give one such as 192.168.1.20; 127.0.0.1 is this machine.")},
    {"cannot-send", QT_TRANSLATE_NOOP("Errors", "Nothing can be sent there. Look at the address and at the network.")},
    {"no-port", QT_TRANSLATE_NOOP("Errors", "The port cannot be opened. Choose one from 1024 on.")},
    {"not-raw-input", QT_TRANSLATE_NOOP("Errors", "This file is no recording of live input.")},
    {"input-too-long", QT_TRANSLATE_NOOP("Errors", "This recording of live input is too long. Record shorter parts.")},
    {"not-mapped", QT_TRANSLATE_NOOP("Errors", "There is no such mapping.")},
    {"not-mappings", QT_TRANSLATE_NOOP("Errors", "This file holds no mappings of live input.")},
    {"too-many-mappings", QT_TRANSLATE_NOOP("Errors", "There are too many mappings. Remove some first.")},
    {"file-not-found", QT_TRANSLATE_NOOP("Errors", "The file was not found.")},
    {"not-readable", QT_TRANSLATE_NOOP("Errors", "The file cannot be read. Check its permissions.")},
    {"not-writable", QT_TRANSLATE_NOOP("Errors", "The file cannot be written. Check the folder and its permissions.")},
    {"no-version", QT_TRANSLATE_NOOP("Errors", "This version of the project is not there, cannot be read or could not be kept.")},
    {"not-sound", QT_TRANSLATE_NOOP("Errors", "The project cannot be saved, for it would not open again. Undo what was done last. Nothing was replaced.")},
    {"disk-full", QT_TRANSLATE_NOOP("Errors", "There is no room on the disk. Make room or choose another one. Nothing was replaced.")},
    {"unknown-format", QT_TRANSLATE_NOOP("Errors", "This file format is not known. Use OBJ, PLY, STL, glTF, VRM, FBX or DAE.")},
    {"bad-file", QT_TRANSLATE_NOOP("Errors", "The file is damaged and cannot be used.")},
    {"old-gltf", QT_TRANSLATE_NOOP("Errors", "The file is glTF 1. Export it again as glTF 2.0, or convert it with gltf-pipeline.")},
    {"old-fbx", QT_TRANSLATE_NOOP("Errors", "The file is FBX older than version 7. Export it as FBX 2011 or later, or convert it with Autodesk’s FBX Converter.")},
    {"splats", QT_TRANSLATE_NOOP("Errors", "The file holds gaussian splats, which have no surface. Make a mesh of it in the program that it came from.")},
    {"not-an-avatar", QT_TRANSLATE_NOOP("Errors", "A VRM file is one avatar with all humanoid bones. Begin with a VRM file, or export glTF.")},
    {"no-counterpart", QT_TRANSLATE_NOOP("Errors", "No bone of the clips has a counterpart in the skeleton of the character.")},
    {"non-finite", QT_TRANSLATE_NOOP("Errors", "The mesh has vertices that are not finite numbers.")},
    {"too-far", QT_TRANSLATE_NOOP("Errors", "The mesh reaches farther than 1e9 m from the origin. Choose a smaller unit, or scale the mesh down in the program that made it.")},
    {"empty-mesh", QT_TRANSLATE_NOOP("Errors", "There is no mesh in the file.")},
    {"too-large", QT_TRANSLATE_NOOP("Errors", "This is too large.")},
    {"timeout", QT_TRANSLATE_NOOP("Errors", "This took too long.")},
    {"worker-failed", QT_TRANSLATE_NOOP("Errors", "A helper process of the studio crashed. Repair the mesh, or export the file again.")},
    {"worker-killed", QT_TRANSLATE_NOOP("Errors", "The system or another program ended a helper process of the studio. Try again.")},
    {"cancelled", QT_TRANSLATE_NOOP("Errors", "Cancelled.")},
    {"no-memory", QT_TRANSLATE_NOOP("Errors", "There is not enough memory. Use a smaller solver mesh.")},
    {"no-memory-after", QT_TRANSLATE_NOOP("Errors", "It was done, but there was not enough memory for what follows it. Undo takes it back.")},
    {"no-face", QT_TRANSLATE_NOOP("Errors", "The element needs a joint face first.")},
    {"shared-rim", QT_TRANSLATE_NOOP("Errors", "Two joint faces of one element touch each other. Leave a row of vertices between them.")},
    {"nothing-left", QT_TRANSLATE_NOOP("Errors", "Nothing would be left of the joint face.")},
    {"no-free-vertex", QT_TRANSLATE_NOOP("Errors", "Joint faces cover the whole element. Leave some of it free.")},
    {"singular", QT_TRANSLATE_NOOP("Errors", "The element cannot be solved. Check its mesh.")},
    {"not-closed", QT_TRANSLATE_NOOP("Errors", "The mesh is not a closed surface facing outward. Repair it first.")},
    {"inaccurate", QT_TRANSLATE_NOOP("Errors", "The solution is not accurate enough. Check the mesh for slivers.")},
    {"before-release", QT_TRANSLATE_NOOP("Errors", "The project was made before the first release of Imomushi, and cannot be opened. Make it again from its meshes or scripts.")},
    {"newer-version", QT_TRANSLATE_NOOP("Errors", "The project was made by a newer version of Imomushi. Update to open it.")},
    {"not-a-project", QT_TRANSLATE_NOOP("Errors", "This file is not an Imomushi project.")},
    {"nothing-to-undo", QT_TRANSLATE_NOOP("Errors", "There is nothing to undo.")},
    {"nothing-to-redo", QT_TRANSLATE_NOOP("Errors", "There is nothing to redo.")},
    {"script-too-long", QT_TRANSLATE_NOOP("Errors", "This session has been too long for one script: save the project, and the script begins there.")},
    {"no-such-effect", QT_TRANSLATE_NOOP("Errors", "There is no effect of that name.")},
    {"not-enabled", QT_TRANSLATE_NOOP("Errors", "The effect is not turned on.")},
    {"not-automatic", QT_TRANSLATE_NOOP("Errors", "This effect cannot turn on by itself where a pose needs it.")},
    {"bad-target", QT_TRANSLATE_NOOP("Errors", "This effect works on the whole character, not on a single element.")},
    {"no-such-pose", QT_TRANSLATE_NOOP("Errors", "There is no kept pose of that name.")},
    {"nothing-posed", QT_TRANSLATE_NOOP("Errors", "There are no bones and no handles yet: a pose is of them.")},
    {"too-many-poses", QT_TRANSLATE_NOOP("Errors", "There are too many kept poses. Remove some first.")},
    {"bad-pose", QT_TRANSLATE_NOOP("Errors", "A kept pose is broken.")},
    {"no-such-cycle", QT_TRANSLATE_NOOP("Errors", "There is no cycle of that name.")},
    {"cycle-poses", QT_TRANSLATE_NOOP("Errors", "A cycle goes through 2 to 64 kept poses. Choose as many.")},
    {"too-many-cycles", QT_TRANSLATE_NOOP("Errors", "There are too many cycles. Remove some first.")},
    {"pose-in-cycle", QT_TRANSLATE_NOOP("Errors", "A cycle goes through this pose. Remove that cycle, or give it other poses, first.")},
    {"nothing-to-cycle", QT_TRANSLATE_NOOP("Errors", "The character has nothing that could move by itself. Give it bones or handles first.")},
    {"bad-cycle", QT_TRANSLATE_NOOP("Errors", "A cycle is broken.")},
    {"source-not-mapped", QT_TRANSLATE_NOOP("Errors", "Nothing of this source is mapped. Map it first.")},
    {"too-many-calibrated", QT_TRANSLATE_NOOP("Errors", "This source is calibrated in three poses already. Clear one of them first.")},
    {"nothing-measured", QT_TRANSLATE_NOOP("Errors", "Nothing was heard that a pose could say something about. Let the source send, and measure again.")},
    {"measured-alike", QT_TRANSLATE_NOOP("Errors", "The source says the same as in another pose. Take this pose, hold it, and measure again.")},
    {"not-calibrated", QT_TRANSLATE_NOOP("Errors", "This source is not calibrated.")},
    {"bad-calibration", QT_TRANSLATE_NOOP("Errors", "A calibration is broken.")},
    {"no-such-take", QT_TRANSLATE_NOOP("Errors", "There is no take of that name.")},
    {"no-element", QT_TRANSLATE_NOOP("Errors", "There is no character yet. Import an element first.")},
    {"already-recording", QT_TRANSLATE_NOOP("Errors", "A take is being recorded. Stop that first.")},
    {"not-recording", QT_TRANSLATE_NOOP("Errors", "Nothing is being recorded.")},
    {"needs-blender", QT_TRANSLATE_NOOP("Errors", "FBX is made by Blender, which was not found. Install it, or choose glTF.")},
    {"not-converted", QT_TRANSLATE_NOOP("Errors", "Blender could not make the FBX file. Choose glTF instead.")},
    {"no-opengl", QT_TRANSLATE_NOOP("Errors", "OpenGL 3.3 is not available on this machine.")},
    {"already-joined", QT_TRANSLATE_NOOP("Errors", "These joint faces are joined already.")},
    {"bad-command", QT_TRANSLATE_NOOP("Errors", "This is no command.")},
    {"bad-image", QT_TRANSLATE_NOOP("Errors", "A picture is damaged or larger than 8192 pixels a side.")},
    {"bad-json", QT_TRANSLATE_NOOP("Errors", "A line of the script cannot be read.")},
    {"bad-parent", QT_TRANSLATE_NOOP("Errors", "The parent of a bone must touch it, and cannot be one of its children. Choose another parent.")},
    {"bad-place", QT_TRANSLATE_NOOP("Errors", "A bone cannot end there. Choose another place.")},
    {"bad-shader", QT_TRANSLATE_NOOP("Errors", "The graphics driver refuses a shader. Update the driver.")},
    {"bad-size", QT_TRANSLATE_NOOP("Errors", "A picture of this size cannot be drawn.")},
    {"bone-loop", QT_TRANSLATE_NOOP("Errors", "Bones form trees: this one would close a loop.")},
    {"damaged", QT_TRANSLATE_NOOP("Errors", "The project is damaged. Open an earlier version of it.")},
    {"duplicate-key", QT_TRANSLATE_NOOP("Errors", "A key stands twice in one line of the script.")},
    {"face-fixed", QT_TRANSLATE_NOOP("Errors", "A joint face that is joined, of a cut or a handle has no plane of its own. Unjoin it, or move the cut or the handle.")},
    {"gap-too-large", QT_TRANSLATE_NOOP("Errors", "The joint faces are too far apart to be joined. Bring them together first.")},
    {"internal", QT_TRANSLATE_NOOP("Errors", "Something went wrong in the studio. What was done before is kept.")},
    {"missing", QT_TRANSLATE_NOOP("Errors", "A file that belongs to this one was not found.")},
    {"no-bone", QT_TRANSLATE_NOOP("Errors", "There is no bone yet. Add one first.")},
    {"no-free-surface", QT_TRANSLATE_NOOP("Errors", "Joint faces cover the whole surface. Make them smaller.")},
    {"no-heat", QT_TRANSLATE_NOOP("Errors", "No bone reaches a part of the surface. Place bones there.")},
    {"no-such-place", QT_TRANSLATE_NOOP("Errors", "There is no such joint face or end of a bone.")},
    {"no-such-property", QT_TRANSLATE_NOOP("Errors", "There is no such property.")},
    {"no-such-target", QT_TRANSLATE_NOOP("Errors", "There is no element, bone, joint face, handle, cut or effect of that name.")},
    {"not-held", QT_TRANSLATE_NOOP("Errors", "This end of a bone or handle is not held.")},
    {"not-joined", QT_TRANSLATE_NOOP("Errors", "This joint face is not joined.")},
    {"not-precomputed", QT_TRANSLATE_NOOP("Errors", "An element is not precomputed as it is now. Precompute it first.")},
    {"not-pinned", QT_TRANSLATE_NOOP("Errors", "This end of a bone or handle is not pinned.")},
    {"not-solved", QT_TRANSLATE_NOOP("Errors", "The skin weights could not be computed. Repair triangles without area.")},
    {"not-touchable", QT_TRANSLATE_NOOP("Errors", "This point cannot be touched. Choose one of the free surface.")},
    {"not-touched", QT_TRANSLATE_NOOP("Errors", "There is no finger at this point.")},
    {"out-of-memory", QT_TRANSLATE_NOOP("Errors", "The graphics driver has no memory for a picture of this size. Make it smaller.")},
    {"outside", QT_TRANSLATE_NOOP("Errors", "A file that belongs to this one lies outside its folder.")},
    {"same-element", QT_TRANSLATE_NOOP("Errors", "Both joint faces belong to one element. Choose faces of two elements.")},
    {"no-filling", QT_TRANSLATE_NOOP("Errors", "The body cannot be filled with tetrahedra. Repair it, or choose another solver mesh.")},
    {"self-intersecting", QT_TRANSLATE_NOOP("Errors", "The body meets itself. Repair it first, or choose another solver mesh.")},
    {"too-few-vertices", QT_TRANSLATE_NOOP("Errors", "The solver mesh cannot have so few vertices. Choose more.")},
    {"too-many-fingers", QT_TRANSLATE_NOOP("Errors", "There are too many fingers on this element. Lift one.")},
    {"too-many-vertices", QT_TRANSLATE_NOOP("Errors", "The solver mesh cannot have so many vertices. Choose fewer.")},
    {"too-small", QT_TRANSLATE_NOOP("Errors", "There is no surface to cover. Import an element first.")},
    {"no-such-handle", QT_TRANSLATE_NOOP("Errors", "There is no handle of that name.")},
    {"bad-point", QT_TRANSLATE_NOOP("Errors", "The point is too far from the surface.")},
    {"is-handle", QT_TRANSLATE_NOOP("Errors", "A handle moves by itself and cannot be joined.")},
    {"not-a-disc", QT_TRANSLATE_NOOP("Errors", "The disc closes around a limb or has a hole. Make it smaller.")},
    {"bad-detail", QT_TRANSLATE_NOOP("Errors", "The detail of a wrap must be between 0.001 and 0.2 times the diagonal of the mesh.")},
    {"cut-passes", QT_TRANSLATE_NOOP("Errors", "Cuts cannot change on which side of each other they lie. Put this one elsewhere.")},
    {"cuts-touch", QT_TRANSLATE_NOOP("Errors", "Two cuts touch, or are too close to each other. Move one of them away.")},
    {"no-skeleton", QT_TRANSLATE_NOOP("Errors", "No skeleton was found, neither in the file nor in the shape. Cut by hand, or use handles.")},
    {"already-cut", QT_TRANSLATE_NOOP("Errors", "The character has cuts, bones or handles already. Take them out first.")},
    {"no-clip", QT_TRANSLATE_NOOP("Errors", "The character has no such clip: import a file with animations.")},
    {"too-long", QT_TRANSLATE_NOOP("Errors", "The take would not fit into memory: choose fewer frames per second.")},
    {"does-not-separate", QT_TRANSLATE_NOOP("Errors", "The body still hangs together around the cut. Put it where it cuts something off.")},
    {"empty-piece", QT_TRANSLATE_NOOP("Errors", "One side of the cut would have no volume. Move the plane deeper into the body.")},
    {"face-lost", QT_TRANSLATE_NOOP("Errors", "The body changes where a joint face lies. Remove that face first.")},
    {"face-cut", QT_TRANSLATE_NOOP("Errors", "The cut would go through a joint face or touch it. Move the plane away, or remove the face first.")},
    {"bad-proposal", QT_TRANSLATE_NOOP("Errors", "The proposal contradicts itself. Give back the answer of propose, or correct what was changed.")},
    {"on-a-cut", QT_TRANSLATE_NOOP("Errors", "That end of a bone lies on a cut. Move the cut.")},
    {"no-length", QT_TRANSLATE_NOOP("Errors", "A bone would have no length. Choose a place farther away.")},
    {"no-section", QT_TRANSLATE_NOOP("Errors", "The plane does not cross the body. Move it into the body.")},
    {"no-such-character", QT_TRANSLATE_NOOP("Errors", "There is no character of that name.")},
    {"no-such-part", QT_TRANSLATE_NOOP("Errors", "The character has no part of that name.")},
    {"not-rigid", QT_TRANSLATE_NOOP("Errors", "The part is not rigid by itself. Let it follow rigidly before you turn it.")},
    {"no-such-cut", QT_TRANSLATE_NOOP("Errors", "There is no cut of that name.")},
    {"no-volume", QT_TRANSLATE_NOOP("Errors", "No closed body with a volume can be made of this mesh. Give it thickness.")},
    {"not-exact", QT_TRANSLATE_NOOP("Errors", "The mesh had to be mended to be a body. Choose “mended” or “auto”.")},
    {"not-mendable", QT_TRANSLATE_NOOP("Errors", "The mesh cannot be closed by mending. Choose a wrapped body.")},
    {"other-element", QT_TRANSLATE_NOOP("Errors", "The section nearest to the origin of the plane belongs to another element. Put the origin into the section that is meant.")},
    {"part-of-character", QT_TRANSLATE_NOOP("Errors", "This element is a piece of a character. Choose the character, or take out the cut beside it.")},
    {"section-touches-itself", QT_TRANSLATE_NOOP("Errors", "The section touches or crosses itself. Move or turn the plane a little.")},
    {"nothing-to-mirror", QT_TRANSLATE_NOOP("Errors", "Nothing of the selection can be mirrored there.")},
    {"in-the-plane", QT_TRANSLATE_NOOP("Errors", "It lies in the middle of the mirror plane.")},
    {"not-mirrored", QT_TRANSLATE_NOOP("Errors", "That cannot be done on both sides at once. Press X for one side.")},
    {"own-image", QT_TRANSLATE_NOOP("Errors", "It is its own mirror image.")},
    {"image-there", QT_TRANSLATE_NOOP("Errors", "Its mirror image is there already.")},
    {"other-vertices", QT_TRANSLATE_NOOP("Errors", "The skin of the skeleton is for the vertices of the mesh before. Import the skeleton of the new file.")},
    {"no-image", QT_TRANSLATE_NOOP("Errors", "Not all of what it lies on has a mirror image.")},
    {"nothing-to-copy", QT_TRANSLATE_NOOP("Errors", "Nothing of the selection can be copied.")},
    {"nothing-to-paste", QT_TRANSLATE_NOOP("Errors", "Nothing that was copied can be pasted here.")},
    {"loose-end", QT_TRANSLATE_NOOP("Errors", "What it hung on is not there: it is a point of its own.")},
    {"hangs-on-nothing", QT_TRANSLATE_NOOP("Errors", "What it hangs on has no mirror image: it is a point of its own.")},
    {"other-size", QT_TRANSLATE_NOOP("Errors", "The new mesh is far larger or smaller than the old one. Choose its unit.")},
    {"open", QT_TRANSLATE_NOOP("Errors", "The file holds no closed surface. Close its holes first.")},
    {"several-bodies", QT_TRANSLATE_NOOP("Errors", "The file holds several bodies. Choose one with a single body.")},
    {"zero-length", QT_TRANSLATE_NOOP("Errors", "The bone has no length. Let it end at another place.")},
};

// As with errors; %1 is the name that it is about.
const std::map<std::string, const char*> kWarnings = {
    {"not-precomputed", QT_TRANSLATE_NOOP("Warnings", "“%1” is not precomputed and follows its bones rigidly. Precompute it first.")},
    {"draft", QT_TRANSLATE_NOOP("Warnings", "“%1” goes out as a draft. Precompute it for what its settings ask for.")},
    {"poses-only", QT_TRANSLATE_NOOP("Warnings", "The character is not what it was when “%1” was recorded. Its poses are written without what effects added.")},
    {"texture-format", QT_TRANSLATE_NOOP("Warnings", "The texture “%1” is neither PNG nor JPEG, which glTF needs, and was left out.")},
    {"uneven-frames", QT_TRANSLATE_NOOP("Warnings", "The frames of “%1” are not evenly spaced, which PC2 needs. Choose a frame rate.")},
};

const std::map<std::string, const char*> kSteps = {
    {"new", QT_TRANSLATE_NOOP("Steps", "New project")},
    {"open", QT_TRANSLATE_NOOP("Steps", "Open project")},
    {"import-element", QT_TRANSLATE_NOOP("Steps", "Import element")},
    {"import-character", QT_TRANSLATE_NOOP("Steps", "Import character")},
    {"import-skeleton", QT_TRANSLATE_NOOP("Steps", "Import skeleton")},
    {"import-clips", QT_TRANSLATE_NOOP("Steps", "Import clips")},
    {"make-soft", QT_TRANSLATE_NOOP("Steps", "Make soft")},
    {"append", QT_TRANSLATE_NOOP("Steps", "Add project")},
    {"paste", QT_TRANSLATE_NOOP("Steps", "Paste")},
    {"duplicate", QT_TRANSLATE_NOOP("Steps", "Duplicate")},
    {"mirror", QT_TRANSLATE_NOOP("Steps", "Mirror")},
    {"transform", QT_TRANSLATE_NOOP("Steps", "Move, turn or scale")},
    {"replace-mesh", QT_TRANSLATE_NOOP("Steps", "Replace mesh")},
    {"repair", QT_TRANSLATE_NOOP("Steps", "Repair mesh")},
    {"cut", QT_TRANSLATE_NOOP("Steps", "Cut element")},
    {"make-character", QT_TRANSLATE_NOOP("Steps", "Make character")},
    {"move-cut", QT_TRANSLATE_NOOP("Steps", "Move cut")},
    {"remove-cut", QT_TRANSLATE_NOOP("Steps", "Remove cut")},
    {"add-joint-face", QT_TRANSLATE_NOOP("Steps", "Add joint face")},
    {"join", QT_TRANSLATE_NOOP("Steps", "Join faces")},
    {"unjoin", QT_TRANSLATE_NOOP("Steps", "Separate faces")},
    {"handle", QT_TRANSLATE_NOOP("Steps", "Add handle")},
    {"remove-handle", QT_TRANSLATE_NOOP("Steps", "Remove handle")},
    {"attach", QT_TRANSLATE_NOOP("Steps", "Attach part")},
    {"turn-part", QT_TRANSLATE_NOOP("Steps", "Turn part")},
    {"morph", QT_TRANSLATE_NOOP("Steps", "Set morph target")},
    {"express", QT_TRANSLATE_NOOP("Steps", "Show expression")},
    {"add-bone", QT_TRANSLATE_NOOP("Steps", "Add bone")},
    {"edit-bone", QT_TRANSLATE_NOOP("Steps", "Change bone")},
    {"edit-joint-face", QT_TRANSLATE_NOOP("Steps", "Change joint face")},
    {"remove-element", QT_TRANSLATE_NOOP("Steps", "Remove element")},
    {"remove-joint-face", QT_TRANSLATE_NOOP("Steps", "Remove joint face")},
    {"remove-joint", QT_TRANSLATE_NOOP("Steps", "Separate faces")},
    {"remove-bone", QT_TRANSLATE_NOOP("Steps", "Remove bone")},
    {"rename", QT_TRANSLATE_NOOP("Steps", "Rename")},
    {"pin", QT_TRANSLATE_NOOP("Steps", "Pin")},
    {"unpin", QT_TRANSLATE_NOOP("Steps", "Unpin")},
    {"set", QT_TRANSLATE_NOOP("Steps", "Change setting")},
    {"drag", QT_TRANSLATE_NOOP("Steps", "Drag")},
    {"release", QT_TRANSLATE_NOOP("Steps", "Release")},
    {"rest", QT_TRANSLATE_NOOP("Steps", "Rest pose")},
    {"keep-pose", QT_TRANSLATE_NOOP("Steps", "Keep pose")},
    {"apply-pose", QT_TRANSLATE_NOOP("Steps", "Apply pose")},
    {"mirror-pose", QT_TRANSLATE_NOOP("Steps", "Mirror the pose")},
    {"rest-bones", QT_TRANSLATE_NOOP("Steps", "Bones to rest")},
    {"rename-pose", QT_TRANSLATE_NOOP("Steps", "Rename pose")},
    {"remove-pose", QT_TRANSLATE_NOOP("Steps", "Remove pose")},
    {"add-cycle", QT_TRANSLATE_NOOP("Steps", "Make cycle")},
    {"suggest-cycles", QT_TRANSLATE_NOOP("Steps", "Suggest cycles")},
    {"rename-cycle", QT_TRANSLATE_NOOP("Steps", "Rename cycle")},
    {"remove-cycle", QT_TRANSLATE_NOOP("Steps", "Remove cycle")},
    {"precompute", QT_TRANSLATE_NOOP("Steps", "Precompute")},
    {"enable", QT_TRANSLATE_NOOP("Steps", "Turn on")},
    {"disable", QT_TRANSLATE_NOOP("Steps", "Turn off")},
    {"touch", QT_TRANSLATE_NOOP("Steps", "Touch")},
    {"record", QT_TRANSLATE_NOOP("Steps", "Record")},
    {"take-clip", QT_TRANSLATE_NOOP("Steps", "Take of a clip")},
    {"rename-take", QT_TRANSLATE_NOOP("Steps", "Rename take")},
    {"duplicate-take", QT_TRANSLATE_NOOP("Steps", "Duplicate take")},
    {"trim-take", QT_TRANSLATE_NOOP("Steps", "Trim take")},
    {"remove-take", QT_TRANSLATE_NOOP("Steps", "Remove take")},
    {"calibrate-source", QT_TRANSLATE_NOOP("Steps", "Calibrate")},
    {"clear-calibration", QT_TRANSLATE_NOOP("Steps", "Clear calibration")},
    {"map-input", QT_TRANSLATE_NOOP("Steps", "Map input")},
    {"unmap-input", QT_TRANSLATE_NOOP("Steps", "Remove mapping")},
    {"load-mappings", QT_TRANSLATE_NOOP("Steps", "Load mappings")},
    {"suggest-mappings", QT_TRANSLATE_NOOP("Steps", "Suggest mappings")},
    {"live", QT_TRANSLATE_NOOP("Steps", "Perform")},
};

const std::map<std::string, const char*> kIssues = {
    {"unwelded", QT_TRANSLATE_NOOP("Issues", "Vertices lie at the same place and are not one.")},
    {"open", QT_TRANSLATE_NOOP("Issues", "The surface has open edges. Close its holes.")},
    {"non-manifold-edge", QT_TRANSLATE_NOOP("Issues", "More than two triangles meet at an edge.")},
    {"non-manifold-vertex", QT_TRANSLATE_NOOP("Issues", "Parts of the surface touch at a single vertex.")},
    {"inverted", QT_TRANSLATE_NOOP("Issues", "The surface faces inward.")},
    {"mixed-winding", QT_TRANSLATE_NOOP("Issues", "Neighbouring triangles face different ways.")},
    {"degenerate", QT_TRANSLATE_NOOP("Issues", "Some triangles have no area.")},
    {"duplicate-triangle", QT_TRANSLATE_NOOP("Issues", "Some triangles exist twice.")},
    {"self-intersection", QT_TRANSLATE_NOOP("Issues", "The surface passes through itself.")},
    {"components", QT_TRANSLATE_NOOP("Issues", "The mesh has several separate parts. Import them as one element each.")},
    {"non-finite", QT_TRANSLATE_NOOP("Issues", "Some coordinates are not finite numbers.")},
    {"unused-vertex", QT_TRANSLATE_NOOP("Issues", "Some vertices belong to no triangle.")},
    {"huge", QT_TRANSLATE_NOOP("Issues", "The mesh is very large. Check its unit.")},
    {"tiny", QT_TRANSLATE_NOOP("Issues", "The mesh is very small. Check its unit.")},
    {"far-from-origin", QT_TRANSLATE_NOOP("Issues", "The mesh lies far from the origin.")},
    {"not-triangles", QT_TRANSLATE_NOOP("Issues", "Faces with more than three corners were split.")},
    {"united", QT_TRANSLATE_NOOP("Issues", "Overlapping parts were united in the body.")},
    {"inside", QT_TRANSLATE_NOOP("Issues", "Parts inside of others were left out of the body; the flesh around carries them.")},
    {"differs", QT_TRANSLATE_NOOP("Issues", "The body is not quite the mesh. Choose another way to make it, or repair the mesh.")},
    {"parted", QT_TRANSLATE_NOOP("Issues", "The surface touched itself. The body has a little room there.")},
    {"untangled", QT_TRANSLATE_NOOP("Issues", "The surface crosses itself. The body has other triangles there.")},
    {"linked", QT_TRANSLATE_NOOP("Issues", "Parts that do not touch were linked by tubes of flesh.")},
    {"link-refused", QT_TRANSLATE_NOOP("Issues", "A link was not made: its two parts must face each other all around it, and touch nowhere else.")},
    {"attached", QT_TRANSLATE_NOOP("Issues", "Parts without a motion of their own were left out of the body, which carries them.")},
    {"open-part", QT_TRANSLATE_NOOP("Issues", "Open parts were left out of the body, which carries them.")},
    {"inner-wall", QT_TRANSLATE_NOOP("Issues", "Walls inside of the flesh were left out of the body.")},
    {"wrapped", QT_TRANSLATE_NOOP("Issues", "A new surface around everything was made.")},
    {"closed-gap", QT_TRANSLATE_NOOP("Issues", "The body closes gaps: what lies on their two sides moves as one.")},
    {"left-out",
     QT_TRANSLATE_NOOP(
         "Issues",
         "Some steps failed or did not finish on this surface, and were skipped. Repair the mesh to get the whole body.")},
    {"flat", QT_TRANSLATE_NOOP("Issues", "The body is extremely thin. Give it more thickness.")},
    {"avatar", QT_TRANSLATE_NOOP("Issues", "A VRM avatar: its humanoid bones, expressions and licence came along.")},
    {"avatar-kept", QT_TRANSLATE_NOOP("Issues", "Springs, first person and look-at of the avatar are kept for export and move nothing here.")},
    {"avatar-constraints", QT_TRANSLATE_NOOP("Issues", "Constraints between bones of the avatar have no effect here, and are not exported.")},
    {"toon", QT_TRANSLATE_NOOP("Issues", "Of toon shading, colours and pictures were imported. Shade colours, rims and outlines are not shown, and not exported.")},
    {"avatar-dropped", QT_TRANSLATE_NOOP("Issues", "Settings of the avatar for pictures, materials and things that were not imported were left out.")},
    {"avatar-damaged", QT_TRANSLATE_NOOP("Issues", "Settings of the avatar that are wrong, or about things that do not exist, were left out.")},
    {"ktx2", QT_TRANSLATE_NOOP("Issues", "Textures in KTX2 are not read and were left out. Export them as PNG or JPEG.")},
    {"splats", QT_TRANSLATE_NOOP("Issues", "Gaussian splats have no surface and were left out.")},
    {"clip-empty", QT_TRANSLATE_NOOP("Issues", "The first animation moves nothing and was left out.")},
    {"clip-pointers", QT_TRANSLATE_NOOP("Issues", "Clips also move lights, cameras or materials, which was left out.")},
    {"non-orientable", QT_TRANSLATE_NOOP("Issues", "The surface has only one side.")},
};

const std::map<std::string, const char*> kMended = {
    {"unwelded", QT_TRANSLATE_NOOP("Issues", "Vertices at the same place were welded.")},
    {"open", QT_TRANSLATE_NOOP("Issues", "Holes were closed.")},
    {"non-manifold-edge", QT_TRANSLATE_NOOP("Issues", "Surfaces that met in one edge were separated.")},
    {"non-manifold-vertex", QT_TRANSLATE_NOOP("Issues", "Surfaces that touched in a vertex were separated.")},
    {"inverted", QT_TRANSLATE_NOOP("Issues", "A surface that faced inward was turned.")},
    {"mixed-winding", QT_TRANSLATE_NOOP("Issues", "Triangles that faced against their neighbours were turned.")},
    {"degenerate", QT_TRANSLATE_NOOP("Issues", "Triangles without area were removed.")},
    {"duplicate-triangle", QT_TRANSLATE_NOOP("Issues", "Copies of triangles were removed.")},
    {"unused-vertex", QT_TRANSLATE_NOOP("Issues", "Vertices of no triangle were left out.")},
};

const std::map<std::string, const char*> kStages = {
    {"read", QT_TRANSLATE_NOOP("Stages", "Reading")},
    {"parse", QT_TRANSLATE_NOOP("Stages", "Reading")},
    {"weld", QT_TRANSLATE_NOOP("Stages", "Welding")},
    {"mend", QT_TRANSLATE_NOOP("Stages", "Mending")},
    {"check", QT_TRANSLATE_NOOP("Stages", "Checking")},
    {"estimate", QT_TRANSLATE_NOOP("Stages", "Estimating")},
    {"assemble", QT_TRANSLATE_NOOP("Stages", "Assembling")},
    {"factorise", QT_TRANSLATE_NOOP("Stages", "Factorising")},
    {"solve", QT_TRANSLATE_NOOP("Stages", "Solving")},
    {"reduce", QT_TRANSLATE_NOOP("Stages", "Reducing")},
    {"prepare", QT_TRANSLATE_NOOP("Stages", "Preparing")},
    {"fit", QT_TRANSLATE_NOOP("Stages", "Fitting")},
    {"write", QT_TRANSLATE_NOOP("Stages", "Writing")},
    {"save", QT_TRANSLATE_NOOP("Stages", "Saving")},
    {"convert", QT_TRANSLATE_NOOP("Stages", "Converting")},
    {"gaps", QT_TRANSLATE_NOOP("Stages", "Looking for gaps")},
    {"wrap", QT_TRANSLATE_NOOP("Stages", "Wrapping")},
    {"coarsen", QT_TRANSLATE_NOOP("Stages", "Coarsening")},
    {"cut", QT_TRANSLATE_NOOP("Stages", "Cutting")},
    {"skeleton", QT_TRANSLATE_NOOP("Stages", "Looking for limbs")},
    {"record", QT_TRANSLATE_NOOP("Stages", "Recording")},
    {"clips", QT_TRANSLATE_NOOP("Stages", "Fitting clips")},
};

}  // namespace

QString errorText(const Error& error) {
    const auto found = kErrors.find(error.code);
    if (found != kErrors.end()) {
        const QString translated = QCoreApplication::translate("Errors", found->second);
        if (translated != QString::fromUtf8(found->second)) return translated;
    }
    QString text = QString::fromStdString(error.message);
    if (text.isEmpty()) return QString::fromStdString(error.code);
    text[0] = text[0].toUpper();
    if (!text.endsWith(u'.') && !text.endsWith(u'!')) text += u'.';
    return text;
}

QString warningText(const Json& warning) {
    const auto found = kWarnings.find(warning.at("code").get<std::string>());
    if (found != kWarnings.end()) {
        const QString translated = QCoreApplication::translate("Warnings", found->second);
        if (translated != QString::fromUtf8(found->second)) return translated.arg(QString::fromStdString(warning.at("subject").get<std::string>()));
    }
    return QString::fromStdString(warning.at("text").get<std::string>());
}

QString stepText(const std::string& command, const std::string& subject) {
    QString name = named(kSteps, "Steps", command);
    if (name.isEmpty()) name = QString::fromStdString(command);
    QString what = QString::fromStdString(subject);
    if (const auto effect = effectNamed(subject)) what = effectTitle(*effect);
    if (command == "import-element" || command == "import-character" || command == "import-skeleton" || command == "import-clips" || command == "append") what = what.section(u'/', -1);  // the file, not its folders
    return what.isEmpty() ? name : Texts::tr("%1: %2", "undo step: what was done, to what").arg(name, what);
}

QString issueText(const MeshIssue& issue) {
    QString text = issue.fixed ? named(kMended, "Issues", issue.code) : QString();
    if (text.isEmpty()) text = named(kIssues, "Issues", issue.code);
    if (text.isEmpty()) text = QString::fromStdString(issue.text);
    return issue.count > 1 ? Texts::tr("%1 (%L2 places)", "mesh issue, number of places").arg(text).arg(issue.count) : text;
}

QString stageText(const std::string& stage) {
    const QString text = named(kStages, "Stages", stage);
    return text.isEmpty() ? QString::fromStdString(stage) : text;
}

QString bytesText(double bytes) { return QLocale().formattedDataSize(qint64(bytes), 1, QLocale::DataSizeTraditionalFormat); }

QString durationText(double seconds) {
    const QLocale locale;
    if (seconds < 0.9995) return Texts::tr("%1 ms").arg(locale.toString(std::max(1.0, std::round(seconds * 1000.0)), 'f', 0));
    if (seconds < 60.0) return Texts::tr("%1 s").arg(locale.toString(seconds, 'f', seconds < 10.0 ? 1 : 0));
    const int whole = int(std::min(seconds, 1e8));
    return Texts::tr("%1 min %2 s").arg(whole / 60).arg(whole % 60);
}

QString clockText(double seconds) {
    const qlonglong hundredths = qlonglong(std::floor(std::clamp(seconds, 0.0, 1e9) * 100.0 + 1e-6));
    return QStringLiteral("%1:%2.%3").arg(hundredths / 6000).arg(hundredths / 100 % 60, 2, 10, QLatin1Char('0')).arg(hundredths % 100, 2, 10, QLatin1Char('0'));
}

QString lengthText(double metres) {
    const QLocale locale;
    const double size = std::abs(metres);
    if (size == 0.0) return QStringLiteral("0 m");
    if (size < 0.01) return QStringLiteral("%1 mm").arg(locale.toString(metres * 1000.0, 'g', 3));
    if (size < 1.0) return QStringLiteral("%1 cm").arg(locale.toString(metres * 100.0, 'g', 3));
    return QStringLiteral("%1 m").arg(locale.toString(metres, size < 1000.0 ? 'g' : 'f', size < 1000.0 ? 4 : 0));
}

QString volumeText(double cubicMetres) {
    const QLocale locale;
    const double size = std::abs(cubicMetres);
    if (size < 1e-3) return QStringLiteral("%1 cm³").arg(locale.toString(cubicMetres * 1e6, 'g', 4));
    if (size < 1.0) return Texts::tr("%1 litres").arg(locale.toString(cubicMetres * 1e3, 'g', 4));
    return QStringLiteral("%1 m³").arg(locale.toString(cubicMetres, 'f', size < 100.0 ? 2 : 0));
}

}  // namespace imomushi
