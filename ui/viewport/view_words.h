// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QString>

namespace imomushi {

class StudioDocument;

/// What is selected and what is under the pointer, translated, for who does not see the view: "Selected: bone “spine”. Under the pointer: nothing".
QString viewWords(const StudioDocument& document);

}  // namespace imomushi
