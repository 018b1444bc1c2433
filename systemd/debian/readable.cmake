# SPDX-License-Identifier: Apache-2.0
# Run by CPack before it packs: folders are everybody's to read, whatever the umask of who builds. (CMake's own permissions of
# folders are taken from what the umask leaves.)
execute_process(COMMAND find "${CPACK_TEMPORARY_DIRECTORY}" -type d -exec chmod 755 {} + COMMAND_ERROR_IS_FATAL ANY)
