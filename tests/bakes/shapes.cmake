# SPDX-License-Identifier: GPL-3.0-or-later
# An empty FOLDER for scenes in which the shape counts: ${hertz}, appended to one, gives Hertz's response everywhere, and
# nothing is solved. PALPATE_ORGANS: the folder with organ files, from the environment.
file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER})
set(PALPATE_ORGANS "$ENV{PALPATE_ORGANS}")
set(hertz "\n[sources]\nrest = \"filled\"\n[[analytic]]\nlaw = \"hertz\"\nyoung = 5000\npoisson = 0.49\n")
include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)
