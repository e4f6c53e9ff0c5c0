// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QObject>
#include <QStringList>
#include <memory>
#include <optional>
#include <vector>

#include "ui/jobs/autosave.h"
#include "ui/jobs/file_job.h"
#include "ui/models/recent_files.h"
#include "ui/models/studio_document.h"

class QWidget;

namespace imomushi {

class StepFlow;
struct MadeBody;
struct PreparedCharacter;

/// New, open, save, import: what asks, where files go, and what is remembered. All changes are commands of the document.
class FileFlow : public QObject {
    Q_OBJECT
public:
    FileFlow(StudioDocument& document, StepFlow& steps, QWidget* window);
    ~FileFlow() override;

    [[nodiscard]] RecentFiles& recent() { return recent_; }
    [[nodiscard]] Autosave& autosave() { return autosave_; }

    /// Asks about the work of studios that ended badly, where there is any. True: some of it is open now.
    bool offerRecovery();

    bool newProject();  ///< false: what is there stays
    void askOpen();
    bool open(const QString& path);  ///< asks about unsaved changes first; false: it was not opened
    bool save();                     ///< false: given up or failed
    bool saveAs();
    void saveCopy();
    /// Asks which version of this project to open, as an unsaved copy.
    void askVersion();
    void saveScript();
    void writeMesh();
    /// What a file is imported for: as the artist says, or to become a soft character, from any mesh or by its skeleton.
    enum class Lead { Anything, Mesh, RiggedFile };
    void askImport(Lead lead = Lead::Anything);
    void import(const QStringList& paths, Lead lead = Lead::Anything);  ///< one dialog after another
    /// Makes an element of its own soft, which becomes a character.
    void makeSoft(const Element& element);
    /// Makes a character soft that is there, by these bones of its skeleton or as proposed.
    void makeSoft(const CharacterSource& character, const std::optional<std::vector<std::string>>& bones = {});
    /// By a command that says how, of a character that is there.
    void makeSoft(const Json& command);
    /// Asks for a file whose bones and clips a character gets.
    void askImportSkeleton(const CharacterSource& character);
    void importSkeleton(const CharacterSource& character, const QString& path);
    /// Asks for a file whose clips the skeleton of a character gets.
    void askImportClips(const CharacterSource& character);
    void importClips(const Json& command);
    void askAppend();
    /// Adds another project to this one, beside it.
    void append(const QString& path);
    /// Asks for another mesh for the character or the element that is selected.
    void askReplaceMesh();
    void replaceMesh(const QString& path);
    /// Projects are opened, or added to this one, as the artist says; meshes imported.
    void drop(const QStringList& paths);
    /// Runs a command that may take bodies that were made for it.
    Result<Json> executeWith(const std::vector<MadeBody>& bodies, const Json& command);
    /// True: go on (saved, or changes are given up).
    bool mayDiscard();
    /// Where files of this project are likely to be wanted.
    [[nodiscard]] QString folder() const;

signals:
    void leaving();  ///< the document is about to be left: what is unfinished must end now
    void opened();                     ///< another document is there
    void imported(int elements);
    void skeletonCame(const QString& character, const QString& message);  ///< its bones may become elements next
    void performable();  ///< what came can be dragged at once
    void saved(const QString& path);   ///< a picture may be taken now
    void working(const QString& what);  ///< on something that takes its time
    void worked(const QString& what);   ///< the same has ended
    void said(const QString& message);
    void warned(const QString& message);

private:
    enum class Dropped { Open, Append, Nothing };
    Dropped askDropped(const QString& path);
    /// All that can become soft is, and something can be dragged.
    [[nodiscard]] bool opensSoft() const;
    bool saveTo(const QString& path);
    /// "open" and "save", with the file read or written in the background.
    Result<Json> read(const Json& open);
    Result<Json> write(const Json& save);
    void nextImport();
    /// The selected character that has a skeleton, else the first; null: none has.
    [[nodiscard]] const CharacterSource* openCharacter() const;
    void finishImport(const Json& answer);
    void madeSoft(const Json& answer, bool isNew);
    void replacedMesh(const QString& name, const Json& answer);
    void startSoft(const Json& command, const QString& name, const std::shared_ptr<const PreparedCharacter>& made);

    StudioDocument& document_;
    StepFlow& steps_;
    QWidget* window_;
    RecentFiles recent_;
    Autosave autosave_;
    FileJob file_;
    QString working_;  ///< what file_ does
    struct Waiting {
        QString path;
        Lead lead;
    };
    QList<Waiting> waiting_;
    bool importing_ = false;
};

}  // namespace imomushi
