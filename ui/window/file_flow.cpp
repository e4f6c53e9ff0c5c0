// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/window/file_flow.h"

#include <QDir>
#include <QEventLoop>
#include <QFileDialog>
#include <QFileInfo>
#include <QGuiApplication>
#include <QMessageBox>
#include <QPushButton>
#include <QSettings>
#include <QStandardPaths>
#include <algorithm>
#include <functional>
#include <utility>
#include <filesystem>

#include "core/commands/proposal_commands.h"
#include "ui/dialogs/import_dialog.h"
#include "ui/dialogs/recovery_dialog.h"
#include "ui/dialogs/versions_dialog.h"
#include "ui/jobs/character_job.h"
#include "ui/jobs/repair_job.h"
#include "ui/models/body_texts.h"
#include "ui/models/commands.h"
#include "ui/models/paths.h"
#include "ui/models/selection_commands.h"
#include "ui/models/texts.h"
#include "ui/scene/document_scene.h"
#include "ui/window/step_flow.h"

namespace imomushi {
namespace {

const QString kSuffix = QStringLiteral("imomushi");

QString withSuffix(const QString& path, const QString& suffix) { return QFileInfo(path).suffix().toLower() == suffix ? path : path + u'.' + suffix; }

QString recoveryFolder() { return QStandardPaths::writableLocation(QStandardPaths::AppDataLocation) + QStringLiteral("/recovery"); }

QString meshFilter(const QStringList& suffixes) {
    QStringList patterns;
    for (const QString& suffix : suffixes) patterns << QStringLiteral("*.") + suffix;
    return FileFlow::tr("Meshes (%1)").arg(patterns.join(u' '));
}

const QStringList kRigged = {QStringLiteral("glb"), QStringLiteral("gltf"), QStringLiteral("vrm"), QStringLiteral("fbx"), QStringLiteral("dae")};
const QString kMeshFolder = QStringLiteral("files/mesh-folder");

/// The folder, or that of which it would be a part, whichever is there.
QString existing(QString folder) {
    while (!folder.isEmpty() && !QFileInfo(folder).isDir()) {
        const QString above = QFileInfo(folder).path();
        if (above == folder || above == u".") break;
        folder = above;
    }
    return QFileInfo(folder).isDir() && folder != u"/" ? folder : QDir::homePath();
}

/// Lets a command take what the dialog has read.
std::function<void(Session&)> asRead(const ImportDialog& dialog) {
    return [request = dialog.request(), elements = dialog.prepared(), character = dialog.preparedCharacter()](Session& session) {
        if (character) usePrepared(session, character);
        session.services().import = [request, elements](const ImportRequest& r, const Progress& progress) -> Result<ImportResult> {
            if (elements && r.path == request.path && r.unit == request.unit && r.up == request.up && r.split == request.split) return *elements;
            return importFile(r, progress);
        };
    };
}

QString pathOf(const Session& session) { return QString::fromStdString(session.path().string()); }

}  // namespace

FileFlow::FileFlow(StudioDocument& document, StepFlow& steps, QWidget* window)
    : QObject(window), document_(document), steps_(steps), window_(window), autosave_(document, recoveryFolder()) {
    connect(&autosave_, &Autosave::failed, &document, &StudioDocument::failed);
    Services& services = document.services();
    services.read = [this](const std::filesystem::path& path, std::optional<std::int64_t> version) -> Result<Project> {
        auto ready = file_.takeRead(path, version);
        return ready ? std::move(*ready) : loadProject(path, version);
    };
    services.write = [this](const std::filesystem::path& path, const Project& project, const VersionLimits& limits) -> Result<SavedProject> {
        auto ready = file_.takeWritten(path, project);
        return ready ? std::move(*ready) : storeProject(path, project, limits);
    };
    file_.setAfterwards([](const Document& read) { decodeTextures(read); });
    connect(&file_, &FileJob::takesTime, this, [this] { Q_EMIT working(working_); });
}

FileFlow::~FileFlow() { document_.services() = coreServices(); }

Result<Json> FileFlow::read(const Json& open) {
    const auto path = open.at("path").get<std::string>();
    working_ = tr("Opening “%1”…").arg(QFileInfo(QString::fromStdString(path)).fileName());
    file_.read(document_.session().registry(), path, open.contains("version") ? std::optional(open["version"].get<std::int64_t>()) : std::nullopt);
    document_.reuseCharacter(file_.takeCharacter());
    auto answer = document_.execute(open);
    Q_EMIT worked(working_);
    if (!answer) return answer;
    const auto names = [&](const char* key) {
        QStringList list;
        for (const Json& name : answer->at(key)) list += QString::fromStdString(name.get<std::string>());
        return list.join(tr(", "));
    };
    if (answer->contains("dropped")) Q_EMIT warned(tr("A newer version of Imomushi wrote this project. Opened as a copy: saving it drops %1.").arg(names("dropped")));
    else if (answer->contains("unknown")) Q_EMIT warned(tr("A newer version of Imomushi wrote this project. This version does not know the following; it keeps it, without effect: %1.").arg(names("unknown")));
    return answer;
}

Result<Json> FileFlow::write(const Json& save) {
    const auto path = save.at("path").get<std::string>();
    working_ = tr("Saving “%1”…").arg(QFileInfo(QString::fromStdString(path)).fileName());
    file_.write(path, document_.project(), document_.session().versionLimits());
    auto answer = document_.execute(save);
    Q_EMIT worked(working_);
    return answer;
}

QString FileFlow::folder() const {
    const QString own = pathOf(document_.session());
    if (!own.isEmpty() && !isSample(own)) return QFileInfo(own).absolutePath();
    return existing(QSettings().value(QStringLiteral("files/folder"), QStandardPaths::writableLocation(QStandardPaths::DocumentsLocation)).toString());
}

bool FileFlow::mayDiscard() {
    Q_EMIT leaving();
    if (!document_.session().modified() && !steps_.running()) return true;
    QMessageBox box(window_);
    box.setIcon(QMessageBox::NoIcon);
    const QString path = pathOf(document_.session());
    box.setWindowTitle(tr("Unsaved changes"));
    box.setText(path.isEmpty() ? tr("Save the changes of this new project?") : tr("Save the changes of “%1”?").arg(QFileInfo(path).completeBaseName()));
    box.setInformativeText(tr("If you don’t save them, they are lost."));
    auto* keep = box.addButton(tr("Save"), QMessageBox::AcceptRole);
    auto* drop = box.addButton(tr("Don’t save"), QMessageBox::DestructiveRole);
    auto* cancel = box.addButton(tr("Cancel"), QMessageBox::RejectRole);
    box.setDefaultButton(keep);
    box.setEscapeButton(cancel);
    box.exec();
    if (box.clickedButton() == drop) steps_.cancel();
    if (box.clickedButton() != keep) return box.clickedButton() == drop;
    if (steps_.running()) {  // what was asked for belongs to it; it can be cancelled
        QEventLoop loop;
        connect(&steps_, &StepFlow::changed, &loop, [&] {
            if (!steps_.running()) loop.quit();
        });
        loop.exec();
    }
    return save();
}

bool FileFlow::offerRecovery() {
    const QList<Autosave::Found> found = autosave_.found();
    if (found.isEmpty()) return false;
    RecoveryDialog dialog(found, window_);
    if (dialog.exec() != QDialog::Accepted) return false;
    const Autosave::Found chosen = found.at(dialog.chosen());
    // What was saved later is not replaced by older work unasked: that is a new project then.
    if (!read(commands::openAs(chosen.file.toStdString(), chosen.outdated ? std::string() : chosen.original.toStdString()))) return false;
    autosave_.takeUp(chosen);
    Q_EMIT opened();
    return true;
}

bool FileFlow::newProject() {
    if (!mayDiscard() || !document_.execute(commands::newProject())) return false;
    Q_EMIT opened();
    return true;
}

void FileFlow::askOpen() {
    const QString path = QFileDialog::getOpenFileName(window_, tr("Open a project"), folder(), tr("Imomushi projects (*.imomushi)"));
    if (!path.isEmpty()) open(path);
}

bool FileFlow::open(const QString& path) {
    if (!mayDiscard()) return false;
    const auto answer = read(commands::open(path.toStdString()));
    if (!answer) return false;
    if (!isSample(path)) QSettings().setValue(QStringLiteral("files/folder"), QFileInfo(path).absolutePath());
    recent_.add(path);
    Q_EMIT opened();
    if (opensSoft()) Q_EMIT performable();
    return true;
}

bool FileFlow::opensSoft() const {
    const Document& document = document_.document();
    const bool movable = !document.bones.empty() || std::any_of(document.elements.begin(), document.elements.end(), [](const auto& e) { return !e.second->handles.empty(); });
    return movable && std::all_of(document.elements.begin(), document.elements.end(), [&](const auto& e) {
        return e.second->faces.empty() || document_.session().responseState(e.first) != Session::ResponseState::None;
    });
}

bool FileFlow::saveTo(const QString& path) {
    const auto answer = write(commands::save(path.toStdString()));
    if (!answer) return false;
    recent_.add(path);
    Q_EMIT saved(path);
    if (answer->contains("not-kept"))
        Q_EMIT warned(tr("Saved “%1”, but no version of it could be kept. %2").arg(QFileInfo(path).fileName(), errorText({"no-version", answer->at("not-kept").get<std::string>()})));
    else
        Q_EMIT said(tr("Saved “%1”").arg(QFileInfo(path).fileName()));
    return true;
}

bool FileFlow::save() {
    const QString path = pathOf(document_.session());
    // Samples are everybody's: a changed one becomes the artist's own file.
    return path.isEmpty() || isSample(path) ? saveAs() : saveTo(path);
}

bool FileFlow::saveAs() {
    const QString own = pathOf(document_.session());
    const QString name = own.isEmpty() ? tr("Character") : QFileInfo(own).completeBaseName();
    const QString path = QFileDialog::getSaveFileName(window_, tr("Save the project as"), QDir(folder()).filePath(name + u'.' + kSuffix), tr("Imomushi projects (*.imomushi)"));
    if (path.isEmpty()) return false;
    QSettings().setValue(QStringLiteral("files/folder"), QFileInfo(path).absolutePath());
    return saveTo(withSuffix(path, kSuffix));
}

void FileFlow::saveCopy() {
    const QString own = pathOf(document_.session());
    const QString name = own.isEmpty() ? tr("Character") : QFileInfo(own).completeBaseName();
    QString path = QFileDialog::getSaveFileName(window_, tr("Save a copy"), QDir(folder()).filePath(tr("%1 copy").arg(name) + u'.' + kSuffix), tr("Imomushi projects (*.imomushi)"));
    if (path.isEmpty()) return;
    path = withSuffix(path, kSuffix);
    if (write(commands::saveCopy(path.toStdString()))) Q_EMIT said(tr("Saved a copy as “%1”").arg(QFileInfo(path).fileName()));
}

void FileFlow::askVersion() {
    const QString path = pathOf(document_.session());
    if (path.isEmpty()) return;
    const auto versions = projectVersions(path.toStdString());
    if (!versions) {
        Q_EMIT warned(errorText(versions.error()));
        return;
    }
    VersionsDialog dialog(*versions, QFileInfo(path).completeBaseName(), window_);
    if (dialog.exec() != QDialog::Accepted || !mayDiscard()) return;
    if (read(commands::openVersion(path.toStdString(), versions->at(dialog.chosen()).number))) Q_EMIT opened();
}

void FileFlow::saveScript() {
    const QString path = QFileDialog::getSaveFileName(window_, tr("Save this session as a script"), QDir(folder()).filePath(QStringLiteral("script.jsonl")), tr("Scripts (*.jsonl)"));
    if (path.isEmpty()) return;
    if (document_.execute(commands::saveScript(path.toStdString()))) Q_EMIT said(tr("Saved “%1”").arg(QFileInfo(path).fileName()));
}

void FileFlow::writeMesh() {
    const QString path = QFileDialog::getSaveFileName(window_, tr("Write the posed mesh"), QDir(folder()).filePath(QStringLiteral("pose.obj")), tr("Meshes (*.obj *.ply)"));
    if (path.isEmpty()) return;
    std::optional<std::string> element;
    const auto& selection = document_.selection();
    if (selection.size() == 1 && selection.front().kind == SelectionItem::Kind::Element)
        element = document_.document().elements.at(selection.front().part)->name;
    const CharacterSource* character = selection.size() == 1 ? characterOf(document_.document(), selection.front()) : nullptr;
    const Json command = character ? commands::writeCharacterMesh(path.toStdString(), character->name) : commands::writeMesh(path.toStdString(), element);
    if (document_.execute(command)) Q_EMIT said(tr("Wrote “%1”").arg(QFileInfo(path).fileName()));
}

void FileFlow::askImport(Lead lead) {
    const QStringList suffixes = lead == Lead::RiggedFile ? kRigged : meshSuffixes();
    const QString title = lead == Lead::RiggedFile ? tr("From a rigged file") : lead == Lead::Mesh ? tr("From a mesh") : tr("Import meshes");
    const QString start = existing(QSettings().value(kMeshFolder, folder()).toString());
    const QStringList paths = QFileDialog::getOpenFileNames(window_, title, start, meshFilter(suffixes));
    if (paths.isEmpty()) return;
    QSettings().setValue(kMeshFolder, QFileInfo(paths.first()).absolutePath());
    import(paths, lead);
}

void FileFlow::import(const QStringList& paths, Lead lead) {
    for (const QString& path : paths) waiting_.push_back({path, lead});
    if (!importing_) nextImport();
}

void FileFlow::nextImport() {
    if (waiting_.isEmpty()) return;
    importing_ = true;
    const Waiting next = waiting_.takeFirst();
    auto* dialog = new ImportDialog(next.path, window_);
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    if (next.lead != Lead::Anything) dialog->leadToSoft(next.lead == Lead::RiggedFile);
    if (const CharacterSource* character = openCharacter()) dialog->offerClips(character->name);
    connect(dialog, &QDialog::finished, this, [this, dialog, path = next.path](int answer) {
        importing_ = false;
        if (answer == QDialog::Accepted) {
            const Json command = dialog->command();
            if (command.at("do") == "import-clips") {
                importClips(command);
            } else if (commands::isMakeSoft(command)) {
                startSoft(command, QFileInfo(path).completeBaseName(), dialog->preparedCharacter());
            } else {
                document_.executeSlow({command, tr("Importing “%1”").arg(QFileInfo(path).fileName()), [this](const Json& done) { finishImport(done); }, asRead(*dialog), dialog->vertices()});
            }
        }
        nextImport();
    });
    dialog->open();
}

const CharacterSource* FileFlow::openCharacter() const {
    const Document& d = document_.document();
    const auto moves = [](const CharacterSource* c) { return c && c->rig && !c->rig->bones.empty(); };
    for (const SelectionItem& item : document_.selection())
        if (const CharacterSource* c = characterOf(d, item); moves(c)) return c;
    for (const auto& [id, character] : d.characters)
        if (moves(character.get())) return character.get();
    return nullptr;
}

void FileFlow::finishImport(const Json& answer) {
    const Json& elements = answer.at("elements");
    const Document& d = document_.document();
    std::vector<SelectionItem> items;
    if (answer.contains("characters")) {
        for (const Json& character : answer.at("characters"))
            if (const CharacterSource* c = d.characterNamed(character.at("name").get<std::string>())) items.push_back({SelectionItem::Kind::Character, c->id, {}, false});
    } else {
        for (const Json& element : elements)
            if (const Element* e = d.elementNamed(element.at("name").get<std::string>())) items.push_back({SelectionItem::Kind::Element, e->id, {}, false});
    }
    document_.select(items);
    Q_EMIT imported(int(elements.size()));
    if (const CharacterSource* c = items.empty() ? nullptr : characterOf(d, items.front()))
        Q_EMIT said(tr("Imported “%1” as a whole character. Its body: %2.").arg(QString::fromStdString(c->name), bodyKindText(c->body->report.how)));
}

void FileFlow::startSoft(const Json& command, const QString& name, const std::shared_ptr<const PreparedCharacter>& made) {
    SlowStep step;
    step.command = command;
    step.title = tr("Making “%1” soft").arg(name);
    step.done = [this, isNew = made != nullptr](const Json& answer) { madeSoft(answer, isNew); };
    if (made) step.arrange = [made](Session& session) { usePrepared(session, made); };
    steps_.start(std::move(step));
}

void FileFlow::makeSoft(const CharacterSource& character, const std::optional<std::vector<std::string>>& bones) {
    startSoft(commands::makeSoft(character.name, bones), QString::fromStdString(character.name), nullptr);
}

void FileFlow::makeSoft(const Element& element) { startSoft(commands::makeElementSoft(element.name), QString::fromStdString(element.name), nullptr); }

void FileFlow::makeSoft(const Json& command) { startSoft(command, QString::fromStdString(command.at("character").get<std::string>()), nullptr); }

void FileFlow::askImportSkeleton(const CharacterSource& character) {
    const std::string name = character.name;  // the document may be another one after the dialog
    const QString start = existing(QSettings().value(kMeshFolder, folder()).toString());
    const QString path = QFileDialog::getOpenFileName(window_, tr("Import a skeleton"), start, meshFilter(kRigged));
    if (path.isEmpty()) return;
    QSettings().setValue(kMeshFolder, QFileInfo(path).absolutePath());
    if (const CharacterSource* now = document_.document().characterNamed(name)) importSkeleton(*now, path);
}

void FileFlow::importSkeleton(const CharacterSource& character, const QString& path) {
    SlowStep step;
    step.command = commands::importSkeleton(character.name, path.toStdString());
    step.title = tr("Importing the skeleton of “%1”").arg(QFileInfo(path).fileName());
    step.done = [this, name = QString::fromStdString(character.name)](const Json& answer) {
        QString text = tr("“%1” has a skeleton of %n bone(s) now.", nullptr, int(answer.at("skeleton").size())).arg(name);
        if (const int clips = int(answer.at("clips").size()); clips > 0) text += u' ' + tr("%n clip(s) came along.", nullptr, clips);
        Q_EMIT skeletonCame(name, text);
    };
    steps_.start(std::move(step));
}

void FileFlow::askImportClips(const CharacterSource& character) {
    const std::string name = character.name;  // the document may be another one after the dialog
    const QString start = existing(QSettings().value(kMeshFolder, folder()).toString());
    const QString path = QFileDialog::getOpenFileName(window_, tr("Import clips"), start, meshFilter(kRigged));
    if (path.isEmpty()) return;
    QSettings().setValue(kMeshFolder, QFileInfo(path).absolutePath());
    if (document_.document().characterNamed(name)) importClips(commands::importClips(name, {path.toStdString(), {}, {}}));
}

void FileFlow::importClips(const Json& command) {
    SlowStep step;
    step.command = command;
    step.title = tr("Importing the clips of “%1”").arg(QFileInfo(QString::fromStdString(command.at("path").get<std::string>())).fileName());
    step.done = [this, name = QString::fromStdString(command.at("character").get<std::string>())](const Json& answer) {
        const Json& clips = answer.at("clips");
        QString text = tr("“%1” has %n clip(s) more: make takes of them.", nullptr, int(clips.size())).arg(name);
        QStringList lost;
        for (const Json& clip : clips)
            for (const Json& bone : clip.at("not_followed")) lost << QString::fromStdString(bone.get<std::string>());
        lost.removeDuplicates();
        constexpr qsizetype kTold = 4;
        if (lost.isEmpty()) {
            Q_EMIT said(text);
            return;
        }
        const QString more = lost.size() > kTold ? tr("%n more", nullptr, int(lost.size() - kTold)) : QString();
        lost = lost.mid(0, kTold);
        if (!more.isEmpty()) lost << more;
        Q_EMIT warned(text + u' ' + tr("These bones of the clips have no counterpart in it: %1").arg(lost.join(QStringLiteral(", "))));
    };
    steps_.start(std::move(step));
}

void FileFlow::madeSoft(const Json& answer, bool isNew) {
    const CharacterSource* character = document_.document().characterNamed(answer.at("character").get<std::string>());
    if (!character) return;
    document_.select({{SelectionItem::Kind::Character, character->id, {}, false}});
    if (isNew) Q_EMIT imported(int(answer.at("elements").size()));
    QString text = tr("“%1” is soft: drag it, or change its cuts and bones.").arg(QString::fromStdString(character->name));
    if (const int n = int(answer.at("refused").size()); n > 0) text += u' ' + tr("%n proposal(s) could not be made.", nullptr, n);
    Q_EMIT said(text);
    Q_EMIT performable();
}

Result<Json> FileFlow::executeWith(const std::vector<MadeBody>& bodies, const Json& command) {
    const BodyMaker usual = std::exchange(document_.services().makeBody, [&bodies](const RenderModel& model, const Rig* rig, const BodySetting& setting, const Progress& progress) -> Result<Body> {
        for (const MadeBody& ready : bodies)
            if (ready.isOf(model, setting)) return ready.body;
        return makeBody(model, rig, setting, progress);
    });
    auto answer = document_.execute(command);
    document_.services().makeBody = usual;
    return answer;
}

void FileFlow::askAppend() {
    const QString path = QFileDialog::getOpenFileName(window_, tr("Add a project"), folder(), tr("Imomushi projects (*.imomushi)"));
    if (!path.isEmpty()) append(path);
}

void FileFlow::append(const QString& path) {
    SlowStep step;
    step.command = commands::append(path.toStdString(), true);
    step.done = [this, path](const Json& answer) {
        std::vector<SelectionItem> items;
        for (const Json& name : answer.at("elements"))
            if (const Element* e = document_.document().elementNamed(name.get<std::string>())) items.push_back({SelectionItem::Kind::Element, e->id, {}, false});
        document_.select(items);
        Q_EMIT imported(int(items.size()));
        Q_EMIT said(tr("Added “%1” to this project").arg(QFileInfo(path).completeBaseName()));
    };
    steps_.start(std::move(step));
}

void FileFlow::askReplaceMesh() {
    const QString start = existing(QSettings().value(kMeshFolder, folder()).toString());
    const QString path = QFileDialog::getOpenFileName(window_, tr("Replace the mesh"), start, meshFilter(meshSuffixes()));
    if (path.isEmpty()) return;
    QSettings().setValue(kMeshFolder, QFileInfo(path).absolutePath());
    replaceMesh(path);
}

void FileFlow::replaceMesh(const QString& path) {
    const Replaceable target = replaceable(document_);
    if (target.name.empty() || importing_) return;
    importing_ = true;
    auto* dialog = new ImportDialog(path, window_);
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    dialog->replaces(target.name, target.character);
    connect(dialog, &QDialog::finished, this, [this, dialog, name = QString::fromStdString(target.name)](int answer) {
        importing_ = false;
        if (answer != QDialog::Accepted) return nextImport();
        document_.executeSlow({dialog->command(), {}, [this, name](const Json& done) { replacedMesh(name, done); }, asRead(*dialog), dialog->vertices()});
        nextImport();
    });
    dialog->open();
}

void FileFlow::replacedMesh(const QString& name, const Json& answer) {
    if (answer.at("lost").empty()) {
        Q_EMIT said(tr("“%1” has its new mesh and kept its rig.").arg(name));
        return;
    }
    QStringList lost;
    for (const Json& part : answer.at("lost"))
        lost << tr("%1 (%2)", "what was lost, why").arg(QString::fromStdString(part.at("name").get<std::string>()), errorText({part.at("code").get<std::string>(), part.at("why").get<std::string>()}));
    constexpr qsizetype kTold = 3;
    const QString more = lost.size() > kTold ? tr("%n more", nullptr, int(lost.size() - kTold)) : QString();
    lost = lost.mid(0, kTold);
    if (!more.isEmpty()) lost << more;
    Q_EMIT warned(tr("“%1” has its new mesh. Lost: %2").arg(name, lost.join(QStringLiteral("; "))));
}

FileFlow::Dropped FileFlow::askDropped(const QString& path) {
    if (document_.document().elements.empty() && document_.document().bones.empty()) return Dropped::Open;
    QMessageBox box(window_);
    box.setIcon(QMessageBox::NoIcon);
    box.setWindowTitle(tr("Dropped project"));
    box.setText(tr("Add “%1” to this project, or open it instead?").arg(QFileInfo(path).completeBaseName()));
    auto* add = box.addButton(tr("Add"), QMessageBox::AcceptRole);
    auto* open = box.addButton(tr("Open"), QMessageBox::ActionRole);
    auto* cancel = box.addButton(tr("Cancel"), QMessageBox::RejectRole);
    box.setDefaultButton(add);
    box.setEscapeButton(cancel);
    box.exec();
    return box.clickedButton() == add ? Dropped::Append : box.clickedButton() == open ? Dropped::Open : Dropped::Nothing;
}

void FileFlow::drop(const QStringList& paths) {
    QStringList meshes, projects, others;
    for (const QString& path : paths) {
        const QString suffix = QFileInfo(path).suffix().toLower();
        (suffix == kSuffix ? projects : meshSuffixes().contains(suffix) ? meshes : others) << path;
    }
    if (!projects.isEmpty()) {
        // One is opened, the others are added beside it.
        const Dropped what = askDropped(projects.first());
        if (what == Dropped::Nothing || (what == Dropped::Open && !open(projects.takeFirst()))) projects.clear();
        for (const QString& path : projects) append(path);
    }
    if (!meshes.isEmpty()) import(meshes);
    if (!others.isEmpty()) Q_EMIT said(tr("“%1” is neither a mesh nor a project.").arg(QFileInfo(others.first()).fileName()));
}

}  // namespace imomushi
