# What Debian wants of the files in a package, just before it is made: the licence by reference, the changes by their name, and pages compressed.
set(share ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/usr/share)
file(REMOVE ${share}/doc/fluidcarve/LICENSE)
file(WRITE ${share}/doc/fluidcarve/copyright "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: fluidcarve

Files: *
Copyright: the authors of fluidcarve
License: Apache-2.0
 The text of the licence is in /usr/share/common-licenses/Apache-2.0.
")
file(RENAME ${share}/doc/fluidcarve/CHANGELOG.md ${share}/doc/fluidcarve/changelog)
execute_process(COMMAND gzip -9n ${share}/doc/fluidcarve/changelog ${share}/man/man1/fluidcarve.1 COMMAND_ERROR_IS_FATAL ANY)
file(RENAME ${share}/zsh/site-functions ${share}/zsh/vendor-completions)
