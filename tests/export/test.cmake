# SPDX-License-Identifier: GPL-3.0-or-later
imomushi_test(export imomushi_document)
