// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/document/import_request.h"

#include "core/document/names.h"

namespace imomushi {

Result<ImportRequest> importRequestFrom(const Document& document, const Json& arguments) {
    ImportRequest request;
    const auto path = pathFrom(arguments);
    if (!path) return tl::unexpected(path.error());
    request.path = *path;
    const auto unit = choiceFrom<Unit>(arguments, "unit", {{"mm", Unit::Millimetre}, {"cm", Unit::Centimetre}, {"m", Unit::Metre}}, Unit::AsInFile);
    if (!unit) return tl::unexpected(unit.error());
    request.unit = *unit;
    const auto up = choiceFrom<UpAxis>(arguments, "up", {{"y", UpAxis::Y}, {"z", UpAxis::Z}}, UpAxis::AsInFile);
    if (!up) return tl::unexpected(up.error());
    request.up = *up;
    if (const Json* name = find(arguments, "name"))
        if (auto ok = checkNewName(document, name->get_ref<const std::string&>()); !ok) return tl::unexpected(ok.error());
    return request;
}

Error importRefusal(const ImportedBody& body) {
    for (const MeshIssue& issue : body.issues)
        if (issue.severity == Severity::Error && !issue.fixed) return {issue.code, "\"" + body.name + "\": " + issue.text};
    return {"open", "\"" + body.name + "\" is not a closed surface: close its holes in a modelling program."};
}

}  // namespace imomushi
