# SPDX-License-Identifier: GPL-3.0-or-later
imomushi_test(memory COST 20 imomushi_reports)
set_target_properties(test_memory PROPERTIES ENABLE_EXPORTS ON)  # it looks its callers up by name
