# SPDX-License-Identifier: Apache-2.0
# Run by lodestar_embed(): the text of FROM as a raw string literal in TO.
file(READ ${FROM} text)
file(WRITE ${TO} "R\"embedded(${text})embedded\"\n")
