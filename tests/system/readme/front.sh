# SPDX-License-Identifier: Apache-2.0
# Supplies what a reader of the main README has: a gyro's recording, a running service, a service manager. See run.py.
blocks=3
elsewhere_1="tools/demo in the stage bench; tools/test is what runs this"

# The programs under their installed names.
on_the_path() {
  work=$(mktemp -d)
  trap 'rm -rf "$work"' EXIT
  mkdir "$work/bin"
  ln -s "$build/tools/ifog/ifog" "$build/daemon/ifogd" "$work/bin"
  PATH=$work/bin:$PATH
  cd "$work"
}

# Replaces systemd according to the units.
systemctl() {
  case "$*" in
    "reload ifogd")
      grep -q '^ExecReload=/bin/kill -HUP $MAINPID' "$build/systemd/ifogd.service" && kill -HUP "$daemon" ;;
    "enable --now ifogd-diagnose.timer")
      # The night, shortened.
      grep -q '^ExecStart=.*/ifog night --config .*/ifogd/ifogd.toml$' "$build/systemd/ifogd-diagnose.service" &&
        ifog night --config /etc/ifogd/ifogd.toml --least-rest 300 ;;
    *) echo "no such unit here: systemctl $*"; return 1 ;;
  esac
}

until_said() {  # WORDS
  local i
  for ((i = 0; i < 200; ++i)); do ! grep -q "$1" "$work/said" || return 0; sleep 0.1; done
  cat "$work/said"
  echo "the daemon did not say: $1"
  return 1
}

before_2() {
  on_the_path
  ln -s "$source/tools" tools
  ifog simulate tools/simulate/scenarios/demo.toml --output recording.kvh --driver kvh1750 --option format=b --option rate_hz=200
  echo 'version = 1' >model.toml
  cat >ifogd.toml <<END
[daemon]
plugin_folder = "$build/plugins"
lock_memory = false
[[sensor]]
name = "nose"
driver = "kvh1750"
model = "model.toml"
[sensor.options]
format = "b"
[sensor.transport]
type = "file"
path = "recording.kvh"
pace = "recorded"
bytes_per_second = 8000
END
  ifogd --config ifogd.toml 2>said &
  daemon=$!
  until_said running
}
after_2() {
  until_said "reloaded: model"
  kill "$daemon"
  wait "$daemon"
  grep -q '^form = ' model.toml
  [ -s before-after.svg ] && [ -s d.html ] && [ -s d.json ]
  rm -rf "$work"
}

before_3() {
  on_the_path
  # A computer with this service, for this shell only.
  cp -r /etc etc 2>/dev/null || true
  mkdir -p etc/ifogd state
  mount --bind etc /etc
  can="--dbc $source/drivers/dbc/examples/ifogd_gyro.dbc --option signal=Rate_x --option counter=Counter --option rate_hz=200"
  ifog simulate "$source/tools/simulate/scenarios/demo.toml" --output day.csv
  ifog convert day.csv day.log $can --option environment=temperature_degC=Temperature
  cat >/etc/ifogd/ifogd.toml <<END
[daemon]
plugin_folder = "$build/plugins"
lock_memory = false
state_folder = "$work/state"
[[sensor]]
name = "nose"
driver = "dbc"
[sensor.transport]
type = "file"
path = "$work/day.log"
format = "candump"
[sensor.options]
dbc = "$source/drivers/dbc/examples/ifogd_gyro.dbc"
signal = "Rate_x"
counter = "Counter"
environment = "temperature_degC=Temperature"
rate_hz = 200
[sensor.record]
folder = "$work/days"
END
  ifogd --config /etc/ifogd/ifogd.toml 2>said
}
after_3() {
  [ "$(ls state | grep -c 'nose.kept-.*toml')" = 1 ] && [ ! -e state/nose.model.toml ]
}
