// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/commands/import_request.h"

#include "core/base/try.h"
#include "core/document/names.h"

namespace imomushi {

Result<ImportRequest> importRequestFrom(const Document& document, const Json& arguments) {
    ImportRequest request;
    IMOMUSHI_TRY(request.path, pathFrom(arguments));
    IMOMUSHI_TRY(request.unit, choiceFrom<Unit>(arguments, "unit", {{"mm", Unit::Millimetre}, {"cm", Unit::Centimetre}, {"m", Unit::Metre}}, Unit::AsInFile));
    IMOMUSHI_TRY(request.up, choiceFrom<UpAxis>(arguments, "up", {{"y", UpAxis::Y}, {"z", UpAxis::Z}}, UpAxis::AsInFile));
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
