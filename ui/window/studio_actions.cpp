// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/window/studio_actions.h"

namespace imomushi {
namespace {

struct Row {
    const char* id;
    const char* icon;
    const char* text;
    const char* keys;  // portable text, several separated by "; "
    bool checkable = false;
};

constexpr Row kRows[] = {
    {"start", "home", QT_TRANSLATE_NOOP("Actions", "Start &page"), "Ctrl+Home"},
    {"new", "new", QT_TRANSLATE_NOOP("Actions", "&New"), "Ctrl+N"},
    {"open", "open", QT_TRANSLATE_NOOP("Actions", "&Open…"), "Ctrl+O"},
    {"import", "import", QT_TRANSLATE_NOOP("Actions", "&Import mesh…"), "Ctrl+I"},
    {"import-skeleton", "bones", QT_TRANSLATE_NOOP("Actions", "Import s&keleton…"), ""},
    {"import-clips", "", QT_TRANSLATE_NOOP("Actions", "Impo&rt clips…"), ""},
    {"save", "save", QT_TRANSLATE_NOOP("Actions", "&Save"), "Ctrl+S"},
    {"save-as", "", QT_TRANSLATE_NOOP("Actions", "Save &as…"), "Ctrl+Shift+S"},
    {"save-copy", "", QT_TRANSLATE_NOOP("Actions", "Save a &copy…"), "Ctrl+Alt+S"},
    {"versions", "", QT_TRANSLATE_NOOP("Actions", "&Versions…"), ""},
    {"save-script", "", QT_TRANSLATE_NOOP("Actions", "Save as s&cript…"), ""},
    {"append", "", QT_TRANSLATE_NOOP("Actions", "A&dd a project…"), ""},
    {"export", "export", QT_TRANSLATE_NOOP("Actions", "&Export…"), "Ctrl+E"},
    {"write-mesh", "", QT_TRANSLATE_NOOP("Actions", "&Write posed mesh…"), ""},
    {"quit", "", QT_TRANSLATE_NOOP("Actions", "&Quit"), "Ctrl+Q"},
    {"undo", "undo", QT_TRANSLATE_NOOP("Actions", "&Undo"), "Ctrl+Z"},
    {"redo", "redo", QT_TRANSLATE_NOOP("Actions", "&Redo"), "Ctrl+Shift+Z; Ctrl+Y"},
    {"delete", "trash", QT_TRANSLATE_NOOP("Actions", "&Delete"), "Del"},
    {"rename", "rename", QT_TRANSLATE_NOOP("Actions", "Re&name"), "F2"},
    {"duplicate", "duplicate", QT_TRANSLATE_NOOP("Actions", "D&uplicate"), "Ctrl+D; Shift+D"},
    {"mirror-x", "", QT_TRANSLATE_NOOP("Actions", "Mirror &left and right (X)"), "Ctrl+M"},
    {"mirror-y", "", QT_TRANSLATE_NOOP("Actions", "Mirror &top and bottom (Y)"), ""},
    {"mirror-z", "", QT_TRANSLATE_NOOP("Actions", "Mirror &front and back (Z)"), ""},
    {"replace-mesh", "", QT_TRANSLATE_NOOP("Actions", "Replace &mesh…"), ""},
    {"select-all", "", QT_TRANSLATE_NOOP("Actions", "Select &all elements"), "Ctrl+A"},
    {"select-none", "", QT_TRANSLATE_NOOP("Actions", "Select &none"), "Ctrl+Shift+A"},
    {"select-invert", "", QT_TRANSLATE_NOOP("Actions", "Select what &is not selected"), "Shift+I"},
    {"select-more", "", QT_TRANSLATE_NOOP("Actions", "Select what is ne&xt to it"), "Shift+G"},
    {"select-chain", "", QT_TRANSLATE_NOOP("Actions", "Select the chain of &bones"), "Shift+C"},
    {"preferences", "settings", QT_TRANSLATE_NOOP("Actions", "&Preferences…"), "Ctrl+,"},
    {"tool-select", "select", QT_TRANSLATE_NOOP("Actions", "&Select"), "Q", true},
    {"tool-face", "face", QT_TRANSLATE_NOOP("Actions", "Joint &face"), "J", true},
    {"tool-bone", "bone", QT_TRANSLATE_NOOP("Actions", "&Bone"), "B", true},
    {"tool-handle", "handle", QT_TRANSLATE_NOOP("Actions", "Ha&ndle"), "N", true},
    {"tool-pose", "pose", QT_TRANSLATE_NOOP("Actions", "&Drag"), "D", true},
    {"tool-touch", "touch", QT_TRANSLATE_NOOP("Actions", "&Touch"), "T", true},
    {"make-soft", "soft", QT_TRANSLATE_NOOP("Actions", "&Make it soft"), "Shift+M"},
    {"make-soft-bones", "", QT_TRANSLATE_NOOP("Actions", "Make it soft by &chosen bones…"), ""},
    {"propose", "cut", QT_TRANSLATE_NOOP("Actions", "Propose bones &and cuts"), "Shift+B"},
    {"precompute", "precompute", QT_TRANSLATE_NOOP("Actions", "&Precompute"), "P"},
    {"soft-at-once", "", QT_TRANSLATE_NOOP("Actions", "Soft at &once"), "", true},
    {"passing-handles", "", QT_TRANSLATE_NOOP("Actions", "Dra&g the body anywhere"), "Shift+N", true},
    {"join", "joint", QT_TRANSLATE_NOOP("Actions", "&Join the selected joint faces"), "Ctrl+J"},
    {"pin", "pin", QT_TRANSLATE_NOOP("Actions", "P&in or unpin"), "Shift+P"},
    {"release", "release", QT_TRANSLATE_NOOP("Actions", "&Release everything held"), "Shift+R"},
    {"rest", "rest", QT_TRANSLATE_NOOP("Actions", "Back to &rest"), "Alt+R"},
    {"keep-pose", "pose", QT_TRANSLATE_NOOP("Actions", "&Keep the pose"), "Shift+K"},
    {"mirror-pose", "swap", QT_TRANSLATE_NOOP("Actions", "&Mirror the pose"), ""},
    {"rest-bones", "reset", QT_TRANSLATE_NOOP("Actions", "Selected &bones to rest"), ""},
    {"rest-chain", "", QT_TRANSLATE_NOOP("Actions", "&Chains of the selected bones to rest"), ""},
    {"pose-1", "", QT_TRANSLATE_NOOP("Actions", "Pose &1"), "Alt+1"},
    {"pose-2", "", QT_TRANSLATE_NOOP("Actions", "Pose &2"), "Alt+2"},
    {"pose-3", "", QT_TRANSLATE_NOOP("Actions", "Pose &3"), "Alt+3"},
    {"pose-4", "", QT_TRANSLATE_NOOP("Actions", "Pose &4"), "Alt+4"},
    {"pose-5", "", QT_TRANSLATE_NOOP("Actions", "Pose &5"), "Alt+5"},
    {"pose-6", "", QT_TRANSLATE_NOOP("Actions", "Pose &6"), "Alt+6"},
    {"pose-7", "", QT_TRANSLATE_NOOP("Actions", "Pose &7"), "Alt+7"},
    {"pose-8", "", QT_TRANSLATE_NOOP("Actions", "Pose &8"), "Alt+8"},
    {"pose-9", "", QT_TRANSLATE_NOOP("Actions", "Pose &9"), "Alt+9"},
    {"record", "record", QT_TRANSLATE_NOOP("Actions", "&Record"), "R"},
    {"play", "play", QT_TRANSLATE_NOOP("Actions", "&Play"), "Space"},
    {"take-back", "frame-back", QT_TRANSLATE_NOOP("Actions", "Frame &back"), "Alt+,"},
    {"take-forward", "frame-forward", QT_TRANSLATE_NOOP("Actions", "Frame &forward"), "Alt+."},
    {"loop", "loop", QT_TRANSLATE_NOOP("Actions", "&Loop"), "Alt+L", true},
    {"mark-in", "mark-in", QT_TRANSLATE_NOOP("Actions", "Play fro&m here"), "I"},
    {"mark-out", "mark-out", QT_TRANSLATE_NOOP("Actions", "Play &until here"), "O"},
    {"mark-none", "", QT_TRANSLATE_NOOP("Actions", "Play the &whole take"), "Alt+I"},
    {"trim-take", "trim", QT_TRANSLATE_NOOP("Actions", "&Trim the take to its marks"), "Alt+T"},
    {"take-clip", "take", QT_TRANSLATE_NOOP("Actions", "Make takes of &clips…"), ""},
    {"rename-take", "rename", QT_TRANSLATE_NOOP("Actions", "Re&name the take"), ""},
    {"duplicate-take", "duplicate", QT_TRANSLATE_NOOP("Actions", "&Duplicate the take"), ""},
    {"remove-take", "trash", QT_TRANSLATE_NOOP("Actions", "Remo&ve the take"), ""},
    {"live-inputs", "live", QT_TRANSLATE_NOOP("Actions", "L&ive inputs"), "Shift+L"},
    {"let-go", "let-go", QT_TRANSLATE_NOOP("Actions", "Let ever&ything go"), "Shift+Esc"},
    {"load-mappings", "open", QT_TRANSLATE_NOOP("Actions", "Load mappin&gs…"), ""},
    {"save-mappings", "save", QT_TRANSLATE_NOOP("Actions", "Save mapping&s…"), ""},
    {"count-in", "count-in", QT_TRANSLATE_NOOP("Actions", "&Count three seconds before recording"), "", true},
    {"leave-take", "live", QT_TRANSLATE_NOOP("Actions", "L&eave the take"), "Shift+Space"},
    {"hide", "eye-off", QT_TRANSLATE_NOOP("Actions", "&Hide the selected elements"), "H"},
    {"show-all", "eye", QT_TRANSLATE_NOOP("Actions", "&Show all elements"), "Alt+H"},
    {"frame-all", "frame", QT_TRANSLATE_NOOP("Actions", "Frame &all"), "Home"},
    {"frame-selection", "", QT_TRANSLATE_NOOP("Actions", "&Frame the selection"), "F"},
    {"view-front", "", QT_TRANSLATE_NOOP("Actions", "Front"), ""},
    {"view-right", "", QT_TRANSLATE_NOOP("Actions", "Right"), ""},
    {"view-top", "", QT_TRANSLATE_NOOP("Actions", "Top"), ""},
    {"orthographic", "", QT_TRANSLATE_NOOP("Actions", "&Orthographic"), "", true},
    {"bones", "bones", QT_TRANSLATE_NOOP("Actions", "Show &bones"), "Alt+B", true},
    {"grid", "grid", QT_TRANSLATE_NOOP("Actions", "Show &ground"), "Alt+G", true},
    {"bodies", "", QT_TRANSLATE_NOOP("Actions", "Show bo&dies"), "", true},
    {"xray", "", QT_TRANSLATE_NOOP("Actions", "&See through bodies"), "Alt+X", true},
    {"picture", "", QT_TRANSLATE_NOOP("Actions", "Save a p&icture…"), "F12"},
    {"full-screen", "", QT_TRANSLATE_NOOP("Actions", "F&ull screen"), "F11", true},
    {"theme-dark", "", QT_TRANSLATE_NOOP("Actions", "&Dark"), "", true},
    {"theme-light", "", QT_TRANSLATE_NOOP("Actions", "&Light"), "", true},
    {"theme-contrast", "", QT_TRANSLATE_NOOP("Actions", "High &contrast"), "", true},
    {"language-en", "", "English", "", true},
    {"language-ja", "", "日本語", "", true},
    {"search", "search", QT_TRANSLATE_NOOP("Actions", "&Search…"), "F3; Ctrl+Shift+P"},
    {"manual", "manual", QT_TRANSLATE_NOOP("Actions", "Ma&nual"), "Ctrl+F1"},
    {"controls", "mouse", QT_TRANSLATE_NOOP("Actions", "&Mouse and keys"), "F1"},
    {"about", "info", QT_TRANSLATE_NOOP("Actions", "&About Imomushi"), ""},
};

}  // namespace

StudioActions::StudioActions(QWidget* window) : ActionSet(window, "Actions") {
    for (const Row& row : kRows) add(row.id, row.icon, row.text, row.keys, row.checkable);
    retranslate();
}

}  // namespace imomushi
