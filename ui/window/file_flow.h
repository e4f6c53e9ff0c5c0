// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QObject>
#include <QStringList>
#include <memory>
#include <optional>
#include <vector>

#include "ui/jobs/autosave.h"
#include "ui/models/recent_files.h"
#include "ui/models/studio_document.h"

class QWidget;

namespace imomushi {

struct MadeBody;

/// New, open, save, import: what asks, where files go, and what is remembered. All changes are commands of the document.
class FileFlow : public QObject {
    Q_OBJECT
public:
    FileFlow(StudioDocument& document, QWidget* window);
    ~FileFlow() override;

    [[nodiscard]] RecentFiles& recent() { return recent_; }
    [[nodiscard]] Autosave& autosave() { return autosave_; }

    /// Asks about the work of studios that ended badly, where there is any. True: some of it is open now.
    bool offerRecovery();

    void newProject();
    void askOpen();
    void open(const QString& path);  ///< asks about unsaved changes first
    bool save();                     ///< false: given up or failed
    bool saveAs();
    void saveCopy();
    void saveScript();
    void writeMesh();
    void askImport();
    void import(const QStringList& paths);  ///< one dialog after another
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
    void performable();  ///< a character came that can be dragged at once
    void saved(const QString& path);   ///< a picture may be taken now
    void said(const QString& message);
    void warned(const QString& message);

private:
    enum class Dropped { Open, Append, Nothing };
    Dropped askDropped(const QString& path);
    bool saveTo(const QString& path);
    void nextImport();
    void madeSoft(const Json& answer);

    struct Prepared;
    StudioDocument& document_;
    QWidget* window_;
    RecentFiles recent_;
    Autosave autosave_;
    QStringList waiting_;
    bool importing_ = false;
    std::shared_ptr<Prepared> prepared_;
};

}  // namespace imomushi
