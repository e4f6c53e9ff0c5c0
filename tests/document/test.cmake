# SPDX-License-Identifier: GPL-3.0-or-later
imomushi_test(document imomushi_document)
