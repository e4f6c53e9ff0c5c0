// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QDialog>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "core/body/body.h"
#include "core/commands/proposal_commands.h"
#include "core/document/command.h"
#include "core/io/import.h"

class QCheckBox;
class QComboBox;
class QFrame;
class QLabel;
class QListWidget;
class QProgressBar;
class QPushButton;

namespace imomushi {

class CharacterJob;
class ChoiceCard;
class ImportJob;
class MeshPreview;
struct CharacterFile;
struct PreparedCharacter;

/// Asks how a mesh file is to be read, and shows what it would become: elements, or one whole character with a body that moves it, which is the first choice for what is not one
/// clean closed surface. The file is read, and the body made, in the background, again after each choice.
class ImportDialog : public QDialog {
    Q_OBJECT
public:
    explicit ImportDialog(const QString& path, QWidget* parent = nullptr);

    /// The file is to become a character that is soft at once. `rigged`: by the skeleton that it should hold.
    void leadToSoft(bool rigged);
    /// The mesh is to take the place of that of a character (`whole`) or of an element, instead of coming in beside.
    void replaces(const std::string& name, bool whole);

    /// Of a file without a mesh the clips may come in, for this character's skeleton.
    void offerClips(const std::string& character) { clipsFor_ = character; }

    [[nodiscard]] Json command() const;  ///< import-element, import-character, make-soft, replace-mesh or import-clips with what was chosen
    [[nodiscard]] const ImportRequest& request() const;
    [[nodiscard]] std::shared_ptr<const Result<ImportResult>> prepared() const;
    /// Null: it is to become elements.
    [[nodiscard]] std::shared_ptr<const PreparedCharacter> preparedCharacter() const;
    /// That the command brings, as far as they were read.
    [[nodiscard]] std::int64_t vertices() const;

private:
    void read();
    void choose(bool whole);
    [[nodiscard]] bool whole() const;
    void showResult();
    void showElements();
    void showCharacter();
    void showClips(const CharacterFile& file);
    [[nodiscard]] bool soft() const;  ///< it is to be made soft at once
    void chooseBones();
    void chooseLinks();
    /// Asks about a size that cannot be meant, once for each file.
    void askAboutSize(const std::optional<SizeDoubt>& doubt);
    void answerSize(bool takeUnit);
    void say(const QString& text, const char* role);
    void addIssue(const MeshIssue& issue);
    [[nodiscard]] BodySetting body() const;
    [[nodiscard]] bool unmended() const;
    [[nodiscard]] ImportRequest chosen() const;

    QString path_;
    ImportJob* job_;
    CharacterJob* character_;
    ChoiceCard* wholeCard_;
    ChoiceCard* elementsCard_;
    bool chosenByHand_ = false, wantsSkeleton_ = false;
    ProposalRequest asked_;
    std::string replaced_;  ///< name of what gets the mesh, empty: none
    std::string clipsFor_;  ///< name of the character that may get clips, empty: none
    bool noMesh_ = false, clips_ = false;  ///< the file has no mesh; its clips are what comes in
    MeshPreview* preview_;
    QComboBox* unit_;
    QComboBox* up_;
    QCheckBox* split_;
    QCheckBox* soft_;
    bool wantsSoft_ = true;  ///< of whole characters
    QLabel* bodyLabel_;
    QComboBox* body_;
    QLabel* detailLabel_;
    QComboBox* detail_;
    QLabel* bonesLabel_;
    QPushButton* bones_;
    QLabel* linksLabel_;
    QPushButton* links_;
    std::optional<std::vector<FleshLink>> askedLinks_;  // m: as found in a file of another unit they mean nothing
    QFrame* sizeQuestion_;
    QLabel* sizeText_;
    QPushButton *takeUnit_, *keepSize_;
    std::optional<SizeDoubt> doubt_;
    bool unitOfAnswer_ = false;  // it holds for this file alone, not for all of its type
    QLabel* facts_;
    QLabel* verdict_;
    QListWidget* issues_;
    QProgressBar* progress_;
    QLabel* stage_;
    QPushButton* import_;
};

/// Endings that can be imported, for file dialogs and dropped files.
QStringList meshSuffixes();

}  // namespace imomushi
