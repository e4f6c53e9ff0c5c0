// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QString>
#include <string>

#include "core/base/result.h"
#include "core/document/command.h"
#include "core/mesh/health.h"

namespace imomushi {

/// A refused command as one sentence in the language of the studio; English from core where there is no translation.
QString errorText(const Error& error);

/// A warning {code, subject, text} of an answer as one sentence in the language of the studio; English from core where there is no translation.
QString warningText(const Json& warning);

/// "add-bone" -> "Add bone", translated: names of undo steps. `subject`: what it was done to, may be empty.
QString stepText(const std::string& command, const std::string& subject);

/// A mesh issue by its code, translated, one sentence; its own text (English) where the code is unknown.
QString issueText(const MeshIssue& issue);

/// A progress stage ("assemble", "factorise", ...) translated.
QString stageText(const std::string& stage);

/// 1536 -> "1.5 KB".
QString bytesText(double bytes);
/// 75 -> "1 min 15 s"; under a second in ms.
QString durationText(double seconds);
/// 83.456 -> "1:23.45": a place in a take.
QString clockText(double seconds);
/// 0.0123 -> "12.3 mm": the unit that reads best.
QString lengthText(double metres);
/// 0.0123 -> "12.3 litres".
QString volumeText(double cubicMetres);

}  // namespace imomushi
