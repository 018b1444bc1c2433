# SPDX-License-Identifier: Apache-2.0
# Supplies what a reader of msgs/README.md has: the four packages, and a Debian system to install them. See run.py.
blocks=2

# Installs the packages' files for this shell only; their dependencies are already installed.
apt() {
  [ "$1" = install ] || return 1
  local package
  for package in "${@:2}"; do
    case $package in
      ./*.deb) dpkg-deb -x "$package" "$work/root" ;;
      *) dpkg-query -W "$package" ;;
    esac
  done
  mkdir "$work/behind"
  if ! mount -t overlay overlay -o "lowerdir=$work/root/usr:/usr" /usr; then
    echo "no overlay of file systems for this user, to lay the packages over /usr; run as root"
    exit 77
  fi
}

before_1() {
  work=$(mktemp -d)
  cleanup() { rm -rf "$work"; }
  trap cleanup EXIT
  cp -r /etc "$work/etc" 2>/dev/null || true
  mkdir -p "$work/packages" "$work/home" "$work/etc"
  mount --bind "$work/etc" /etc
  mount --bind "$work/home" /root
  cpack --config "$build/CPackConfig.cmake" -B "$work/packages" >"$work/log" 2>&1
  cd "$work/packages"
  # System-wide settings in the block are made by the caller.
  ip route del 224.0.0.0/4
  ip link set lo multicast off
}
after_1() {
  kill %1
  wait
  [ "$(command -v ifog)" = /usr/bin/ifog ]
}

# The window of lcm-spy needs a screen; it prints the known types before.
before_2() {
  if ! command -v java >/dev/null || [ ! -e /usr/share/java/jchart2d.jar ] || ! ls /usr/share/java/ifogd-msgs-*.jar >/dev/null; then
    echo "the Java types were not built, or lcm-spy is missing: tools/install-packages test brings them, then configure again"
    exit 77
  fi
  unset DISPLAY
  java() { timeout 60 "$(type -P java)" "$@" >"$work/spy" 2>&1 || true; }
}
after_2() { grep -q 'Found 5 LCM types' "$work/spy"; }
