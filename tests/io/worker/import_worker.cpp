// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/io/import.h"

int main() { return imomushi::importWorkerMain(); }
