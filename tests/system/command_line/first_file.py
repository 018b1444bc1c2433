#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Logs as new users have them, written by phones, autopilots, ROS, MATLAB, spreadsheets and makers' programs, each with noise of a
known density. A file is read directly, or the options printed in the error message are used; one of them gives the density.
Oracle: the true density; the header lines are from public logs.

usage: first_file.py PATH_OF_IFOG SOURCE_DIR
"""
import datetime
import gzip
import json
import math
import pathlib
import random
import re
import shlex
import struct
import sys

from run import ifog, main_of, ran

ROWS, RATE_HZ = 4000, 200
N = 0.2  # °/√h of every file made here
SIGMA_DPS = N / 60 * math.sqrt(RATE_HZ)
RAD = math.pi / 180
CASES = pathlib.Path(sys.argv[2]).resolve().parent / "shared/cases"


def typed(path, *options, hz=None):
    """N by axis from `ifog allan` with its output, or its error message."""
    output = path.with_suffix(".json")
    result = ran("allan", path, "--json", output, *[str(o).replace("HZ", str(hz)) if hz else o for o in options])
    if result.returncode != 0:
        return None, result.stderr
    document = json.loads(output.read_text())
    densities = {axis["axis"]: axis["coefficients"]["N"]["value"] / RAD * 60 for axis in document["axes"]}
    return densities, result.stdout + result.stderr


def by_hand(path, hz=None):
    """Uses the printed options: the result of the file, or of each line of options."""
    densities, said = typed(path, hz=hz)
    if densities is not None:
        return [densities], said
    assert said.count("\n") == 1, f"{path.name}: more than one line: {said}"
    found = re.search(r"to read it: (.*)\n", said)
    assert found, f"{path.name}: refused without a way: {said}"
    ways, *instead = found.group(1).split("; in the place of ")
    lines = ways.split("; or: ")
    for unit, others in (part.split(": ") for part in instead):
        lines += [re.sub(rf":{unit}(?=['\s]|$)", f":{other}", line) for line in lines for other in others.split(", ")]
    readings = []
    for line in lines:
        read, why = typed(path, "--moving", "keep", *shlex.split(line), hz=hz)  # in a wrong unit it seems to move
        assert read is not None, f"{path.name}: what is printed does not read it: {line}: {why}"
        readings.append(read)
    return readings, said


class Checks:
    def __init__(self, folder):
        self.folder = folder
        dice = random.Random(11)
        self.noise = {axis: [dice.gauss(0, SIGMA_DPS) for _ in range(ROWS)] for axis in "xyz"}

    def file(self, name, lines):
        path = self.folder / name
        text = "\n".join(lines) + "\n"
        path.write_bytes(gzip.compress(text.encode()) if name.endswith(".gz") else text.encode())
        return path

    def rows(self, form, separator=","):
        """One line per sample; form(i, x, y, z) in °/s gives its cells."""
        return [separator.join(map(str, form(i, *(self.noise[a][i] for a in "xyz")))) for i in range(ROWS)]

    def reads(self, name, lines, axes="xyz", hz=None, unasked=None, says=()):
        path = self.file(name, lines)
        readings, said = by_hand(path, hz)
        wanted = set(axes)
        right = [r for r in readings if set(r) == wanted and all(abs(r[a] / N - 1) < 0.05 for a in wanted)]
        assert right, f"{name}: N {readings}, put in {N} on {sorted(wanted)}; said: {said}"
        if unasked is not None:
            assert (len(readings) == 1 and "read as" in said) == unasked, f"{name}: unasked is not {unasked}: {said}"
        for part in says:
            assert part in said, f"{name}: not said: {part}: {said}"

    def check_what_needs_no_option(self):
        self.reads("phyphox.csv", ['"Time (s)","Gyroscope x (rad/s)","Gyroscope y (rad/s)","Gyroscope z (rad/s)","Absolute (rad/s)"',
                                   *self.rows(lambda i, x, y, z: (i / RATE_HZ, x * RAD, y * RAD, z * RAD, 0.1))], unasked=True)
        self.reads("sensorlog.csv", ["loggingTime(txt),motionTimestamp_sinceReboot(s),motionRotationRateX(rad/s),motionRotationRateY(rad/s),motionRotationRateZ(rad/s)",
                                     *self.rows(lambda i, x, y, z: ("phone", f"{80000 + i / RATE_HZ:.6f}", x * RAD, y * RAD, z * RAD))], unasked=True)
        self.reads("euroc.csv", ["#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],a_RS_S_x [m s^-2]",
                                 *self.rows(lambda i, x, y, z: (1403636579758555392 + i * 5_000_000, x * RAD, y * RAD, z * RAD, 9.8))], unasked=True)
        self.reads("vehicle_imu.csv", ["timestamp,accel_device_id,gyro_device_id,delta_angle[0],delta_angle[1],delta_angle[2],delta_angle_dt",
                                       *self.rows(lambda i, x, y, z: (112579605 + 5000 * i, 2621450, 2621450, *(v * RAD / RATE_HZ for v in (x, y, z)), 5000))],
                   unasked=True)
        self.reads("bag.csv", ["header.stamp.sec,header.stamp.nanosec,header.frame_id,angular_velocity.x,angular_velocity.y,angular_velocity.z,angular_velocity_covariance_0",
                               *self.rows(lambda i, x, y, z: (1727992974 + i // RATE_HZ, i % RATE_HZ * 5_000_000, "imu", x * RAD, y * RAD, z * RAD, 0.1))], unasked=True)
        self.reads("shimmer.csv", ["sep=;", "Timestamp;Gyro_X;Gyro_Y;Gyro_Z;Temperature", "ms;deg/s;deg/s;deg/s;degC",
                                   *[line.replace(".", ",") for line in self.rows(lambda i, x, y, z: (1000 + 5.0 * i, x, y, z, 25.5), ";")]], unasked=True)
        self.reads("bias.csv", ["Date,Time (s),gyro_range_dps,gyro_bias_x_dps,gyro_x_dps,gyro_temp_degC",
                                *self.rows(lambda i, x, y, z: ("2026-05-01", i / RATE_HZ, 250, 0.3, x, 24))], axes="x", unasked=True)

    def check_rows_stamped_late_in_bursts_are_even(self):
        """sunsided, set-2: a USB logger stamps some rows 1 ms apart when it gets round to them, and none is missing. Where the device
        sleeps in the pauses, rows are missing."""
        dice, polled, last, pause, late, asleep = random.Random(5), 0.0, 0.0, 0.0, [], []
        for i in range(ROWS):
            if polled < i / RATE_HZ:
                polled = i / RATE_HZ + dice.uniform(0.01, 0.06)
                pause += dice.uniform(0, 0.05)
            last = max(last + 0.001, polled)
            late.append(last)
            asleep.append(0.001 * i + pause)
        head = "time_s,gyro_x_dps,gyro_y_dps,gyro_z_dps"
        self.reads("late.csv", [head, *self.rows(lambda i, *dps: (late[i], *dps))], says=("come in bursts",))
        self.reads("hole.csv", [head, *self.rows(lambda i, *dps: (late[i] + 60 * (2 * i > ROWS), *dps))], says=("come in bursts", "1 gap "))
        said = by_hand(self.file("asleep.csv", [head, *self.rows(lambda i, *dps: (asleep[i], *dps))]))[1]
        assert "bursts" not in said and "samples missing" in said, said

    def check_counts_are_read_by_their_scale(self):
        path = self.file("counts.csv", ["t_ms,GyX,GyY,GyZ", *self.rows(lambda i, x, y, z: (5 * i, *(round(v * 13100) for v in (x, y, z))))])
        scale = ["--time", "t_ms:ms", *(word for a in "xyz" for word in ("--column", f"rate_{a}_radps=Gy{a.upper()}:{1 / 13100}deg/s"))]
        densities, said = typed(path, *scale)
        assert densities and all(abs(densities[a] / N - 1) < 0.05 for a in "xyz"), (densities, said)
        ascii = self.file("ascii.txt", self.rows(lambda i, x, y, z: (f"   {5 * i:.7e}", f"  {x:.7e}"), " "))  # MATLAB: save -ascii
        densities, said = typed(ascii, "--time", "#1:ms", "--column", "rate_x_radps=#2:deg/s")
        assert densities and abs(densities["x"] / N - 1) < 0.05, (densities, said)
        loud = self.file("loud.csv", ["t_ms,GyX", *self.rows(lambda i, x, y, z: (5 * i, round(x * 131000)))])
        said = typed(loud, "--time", "t_ms:ms", "--column", "rate_x_radps=GyX:rad/s")[1]
        assert "counts are read by their scale: --column 'rate_x_radps=GyX:0.00763deg/s'" in said, said

    def check_what_has_a_preamble(self):
        self.reads("maker.txt", ["// General information:", "//  Version: 2022.2.0", "//  Filter Profile: human(46.1)",
                                 "PacketCounter\tSampleTimeFine\tAcc_X\tGyr_X\tGyr_Y\tGyr_Z",
                                 *self.rows(lambda i, x, y, z: ((51400 + i) % 65536, (4294900000 + 50 * i) % 2**32, 9.8, x * RAD, y * RAD, z * RAD), "\t")],
                   unasked=False, says=("SampleTimeFine",))
        self.reads("info.csv", ["FILE_INFO", "ListSeparator=comma", "", "SESSION_INFO", "StartTime,02/10/2017 16:13:52", "", "DATA_START",
                                "GPS TFlags,GPS Week,GPS TOW,Roll [x800C],X Gyro [x8005],Y Gyro [x8005],Z Gyro [x8005],Lat [x8103]",
                                *self.rows(lambda i, x, y, z: (5, 1969, 137649.863104 + i / RATE_HZ, 0.01, x * RAD, y * RAD, z * RAD, ""))])

    def check_what_has_no_time(self):
        self.reads("demo.csv", ["gyro_x (deg/s),gyro_y (deg/s),gyro_z (deg/s)", *self.rows(lambda i, x, y, z: (x, y, z))], hz=RATE_HZ, says=("--sample-rate HZ",))
        self.reads("epson.csv", ["#Log esensorlib,,,Output Rate,200.0,Filter Setting,K32_FC50", "Sample No.,Gx[dps],Gy[dps],Gz[dps]",
                                 *self.rows(lambda i, x, y, z: (i, x, y, z))], says=("counts the rows", "--sample-rate 200"))
        self.reads("bare.csv", self.rows(lambda i, x, y, z: (x, y, z)), hz=RATE_HZ, says=("no header line",))
        self.reads("echo.csv", self.rows(lambda i, x, y, z: (1727992974 + i // RATE_HZ, i % RATE_HZ * 5_000_000, "imu_link", x * RAD, y * RAD, z * RAD)),
                   says=("#1+#2",))
        self.reads("space.txt", self.rows(lambda i, x, y, z: (f"{i / RATE_HZ:.3f} ", x, y, z), " "))

    def check_what_names_no_unit(self):
        self.reads("mavlink.csv", ["time_usec,xgyro,ygyro,zgyro", *self.rows(lambda i, x, y, z: (5000 * i, x * RAD, y * RAD, z * RAD))], unasked=False)
        self.reads("px4.csv", ["timestamp,gyro_rad[0],gyro_rad[1],gyro_rad[2],gyro_integral_dt,accelerometer_timestamp_relative",
                               *self.rows(lambda i, x, y, z: (112574496 + 5000 * i, x * RAD, y * RAD, z * RAD, 5000, 0))], unasked=True)
        self.reads("ardupilot.csv", ["timestamp,TimeUS,I,GyrX,GyrY,GyrZ,AccX,EG,T,GH",
                                     *self.rows(lambda i, x, y, z: (f"{1727992974 + i / RATE_HZ:.6f}", 5000 * i, 0, x * RAD, y * RAD, z * RAD, 9.8, 0, 40, 1))])
        self.reads("rates.csv", ["time_s,p,q,r", *self.rows(lambda i, x, y, z: (i / RATE_HZ, x, y, z))], unasked=False)

    def check_lines_as_sketches_print_them(self):
        """Names before the values, a terminal's time before or above the line; other text is ignored."""
        self.reads("colon.txt", self.rows(lambda i, x, y, z: (f"gx:{x} gy:{y} gz:{z}",)), hz=RATE_HZ, says=("--sample-rate HZ",))
        self.reads("equals.log", ["\x1b[0;32mI (24) boot: 0x68 found\x1b[0m", *self.rows(lambda i, x, y, z: (f"RAW 0x68: acc=(1, 2, -9) gyro=({x}, {y}, {z}) T=25.5",))], hz=RATE_HZ)
        self.reads("json_lines.txt", self.rows(lambda i, x, y, z: (f'{{"time": {i / RATE_HZ}, "gyro_x_dps": {x}, "gyro_y_dps": {y}, "gyro_z_dps": {z}}}',)), unasked=True)

        def at(i):
            return (datetime.datetime(2026, 11, 27, 11, 59, 50) + datetime.timedelta(seconds=i / RATE_HZ)).strftime("%H:%M:%S.%f")[:-3]
        self.reads("monitor.txt", [f"{at(0)} -> gyro_x_dps,gyro_y_dps,gyro_z_dps", *self.rows(lambda i, x, y, z: (f"{at(i)} -> {x},{y},{z}",))], unasked=True)
        self.reads("seconds.txt", ["11:59:49 -> MPU-6050 ready", *self.rows(lambda i, x, y, z: (f"{at(i)[:8]} -> {x}\t{y}\t{z}",))], says=("no header line",))
        self.reads("between.txt", [line for i, row in enumerate(self.rows(lambda i, x, y, z: (x, y, z), "  "))
                                   for line in ([f"2026-11-27   {at(i)[:8]}"] if i % RATE_HZ == 0 else []) + [row]], says=("no header line",))
        self.reads("other_separator.txt", ["A_Z [mg] G_X [dps] G_Y [dps] G_Z [dps] ", *self.rows(lambda i, x, y, z: (1000, x, y, z), "\t")], hz=RATE_HZ, says=("G_X [dps]",))

    def check_dates_as_people_write_them(self):
        """Spreadsheets in German and American format, MATLAB, a maker's program; each begins just before noon."""
        def rows(stamp):
            at = lambda i: datetime.datetime(2026, 11, 27, 11, 59, 50) + datetime.timedelta(seconds=i / RATE_HZ)
            return lambda i, x, y, z: (at(i).strftime(stamp).lstrip("0").replace(" 0", " "), z)

        for name, header, stamp, separator in (("german.csv", "Zeit;Drehrate Z [°/s]", "%d.%m.%Y %H:%M:%S,%f", ";"), ("american.csv", "Date Time,Gyro Z (deg/s)", "%m/%d/%Y %I:%M:%S.%f %p", ","),
                                               ("matlab.csv", "timestamp,Gyro Z (deg/s)", "%d-%b-%Y %H:%M:%S.%f", ","), ("maker.csv", "Time,scaledGyroZ (deg/s)", "%m/%d/%Y %H:%M:%S.%f", ",")):
            lines = self.rows(rows(stamp), separator)
            self.reads(name, [header, *([line.replace(".", ",").replace(",", ".", 2) for line in lines] if separator == ";" else lines)], axes="z", unasked=True)

    def check_names_and_cells_of_others(self):
        self.reads("increments.csv", ["GPS week,GPS sow (s),dTheta_x (arcsec),dTheta_y (arcsec),dTheta_z (arcsec)",
                                      *self.rows(lambda i, x, y, z: (2394, 468000 + i / RATE_HZ, *(v * 3600 / RATE_HZ for v in (x, y, z))))], unasked=True)
        self.reads("quotient.csv", ["datetime,omega_z_deg_h", *self.rows(lambda i, x, y, z: (f"2026-05-01T10:00:{i / RATE_HZ:09.6f}+01:00", 3600 * z))], axes="z", unasked=True)
        self.reads("session.log", ["=~=~=~= PuTTY log 2026.11.27 10:00:00 =~=~=~=", "t_ms,gyro_x_dps", *self.rows(lambda i, x, y, z: (5 * i, x))], axes="x", unasked=True)
        self.reads("Gyroscope.csv", ["time,z,y,x", *self.rows(lambda i, x, y, z: (1795741141800000000 + i * 5_000_000, z * RAD, y * RAD, x * RAD))], unasked=False)
        self.reads("notes.csv", ["Timestamp,Gyro_X(deg/s),Note", *self.rows(lambda i, x, y, z: (i / RATE_HZ, x, '"start, cold ""A"""' if i == 0 else ""))], axes="x", unasked=True)
        path = self.folder / "utf16.csv"
        path.write_text("time_s,rate_x_dps\n0,1\n", encoding="utf-16")
        assert "iconv -f UTF-16" in typed(path)[1], typed(path)[1]

    def check_which_column_is_the_time(self):
        """Several clocks side by side; names of times; a temperature T, a pressure, a count of the rows; digits of a clock; a time out of order."""
        self.reads("phone.csv", ["Time (s),X (m/s^2),Time (s),X (rad/s),Y (rad/s),Z (rad/s)", *self.rows(
            lambda i, x, y, z: (i / RATE_HZ, 9.8, 0.0225 + i * 1.01 / RATE_HZ, x * RAD, y * RAD, z * RAD))], unasked=True, says=("#3",), hz=RATE_HZ / 1.01)
        self.reads("coarse.csv", ["Timestamp,Milliseconds,wx (deg/s)", *self.rows(
            lambda i, x, y, z: (f"2026-11-27 17:25:{16 + i // RATE_HZ:02d}", 6 + 5 * i, x))], axes="x", says=("Milliseconds",))
        self.reads("wit.csv", ["time(s),wx (deg/s),T(°C)", *self.rows(lambda i, x, y, z: (i / RATE_HZ, x, 25 + i // 500))], axes="x", unasked=True)
        self.reads("zeit.csv", ["Zeitstempel;Drehrate X (deg/s)", *self.rows(lambda i, x, y, z: (1700000000000000 + 5000 * i, str(x).replace(".", ",")), ";")], axes="x")
        for name, first_s, factor in (("epoch", 1.7e9, 1), ("GPSTOW", 345600, 1), ("Time_of_week", 345600, 1), ("SecondsOfWeek", 345600, 1), ("tiempo", 0, 1), ("timeus", 0, 1e6)):
            self.reads(f"{name}.csv", [f"{name},rate_degph", *self.rows(lambda i, x, y, z: (f"{(first_s + i / RATE_HZ) * factor:.6f}", 3600 * x))], axes=("",), unasked=True)
        said = by_hand(self.file("pressure.csv", self.rows(lambda i, x, y, z: (967.5372 + 0.0033 * (i // 32 % 2), x, y, z))), RATE_HZ)[1]
        assert "--time" not in said and "--sample-rate HZ" in said and "#2" in said, said
        said = by_hand(self.file("counted.csv", self.rows(lambda i, x, y, z: (275464 + i, x, y, z))), RATE_HZ)[1]
        assert "'#1' counts the rows" in said and "=#1" not in said, said
        said = by_hand(self.file("nmea.csv", ["utc_time(hhmmss.sss),wx (deg/s)", *self.rows(lambda i, x, y, z: (f"{120000 + i / RATE_HZ:.3f}", x))]), RATE_HZ)[1]
        assert "no time column" in said, said
        path = self.file("jitter.csv", ["time,wx (deg/s)", *self.rows(lambda i, x, y, z: (f"{(i + 3 * (i * i % 7) / 7) / RATE_HZ:.4f}", x))])
        said = typed(path)[1]
        assert "jitter.csv:" in said and "--sample-rate HZ reads all rows as even" in said, said
        assert abs(typed(path, "--sample-rate", RATE_HZ)[0]["x"] / N - 1) < 0.05
        path = self.file("names.csv", ["时间(s),角速度X(°/s),温度(°C)", *self.rows(lambda i, x, y, z: (i / RATE_HZ, x, 25))])
        ifog("convert", path, self.folder / "names_read.csv")
        assert "温度_degC" in (self.folder / "names_read.csv").read_text().splitlines()[0]

    def check_rest_is_judged_on_axes_nobody_named(self):
        """An IMU that is turned about y for two seconds; a part of the turn is in x."""
        turned = [300 if 2000 <= i < 2400 else 0 for i in range(ROWS)]
        lines = ["t_s,gyro_x_dps,gyro_y_dps", *self.rows(lambda i, x, y, z: (i / RATE_HZ, x + 1e-3 * turned[i], y + turned[i] if i % 997 else "n/a-text"))]
        path = self.file("turned.csv", lines)
        densities, said = typed(path, "--time", "t_s:s", "--column", "rate_x_radps=gyro_x_dps:deg/s")
        assert densities and abs(densities["x"] / N - 1) < 0.06, (densities, said)
        assert "only the rest is analysed" in said, said

    def check_what_is_suggested_may_be_added_to_what_is_typed(self):
        """A rate beside a time that is stamped in whole ms; a matrix of MATLAB with its time."""
        path = self.file("jitter.csv", ["t,gyro_x_dps", *self.rows(lambda i, x, y, z: (5 * i + i % 3, x))])
        densities, said = typed(path, "--time", "t:ms", "--column", "rate_x_radps=gyro_x_dps:deg/s", "--sample-rate", RATE_HZ)
        assert densities and abs(densities["x"] / N - 1) < 0.05, (densities, said)
        path = self.file("matrix.csv", [",".join(f"gyro[{i}]" for i in range(4)), *self.rows(lambda i, x, y, z: (i / RATE_HZ, x, y, z))])
        densities, said = typed(path, "--time", "gyro[0]:s", "--column", "rate_radps=gyro[1]:deg/s")
        assert densities and abs(densities[""] / N - 1) < 0.05, (densities, said)
        self.reads("matrix.csv", path.read_text().splitlines())
        path = self.file("more.csv", [line + (",T" if i == 0 else ",25") for i, line in enumerate(path.read_text().splitlines())])
        for time in ("gyro[0]:s", "#1:s"):
            assert typed(path, "--time", time, "--column", "rate_radps=gyro[1]:deg/s")[0], time

    def check_two_candidates_are_both_shown(self):
        path = self.file("twice.csv", ["time_s,gyro1_x_dps,gyro2_x_dps", *self.rows(lambda i, x, y, z: (i / RATE_HZ, x, 3 * y))])
        readings, said = by_hand(path)
        assert sorted(round(r["x"] / N) for r in readings) == [1, 3], readings
        assert "more than one column may be the rate" in said, said

    def check_several_sensors_in_one_table(self):
        """As in public repositories: accelerations before unnamed rates, a quaternion with w, rows of two sensors in one table."""
        shape = self.rows(lambda i, x, y, z: (672705976809250 + 5_000_000 * i, -0.12 + 1e-3 * (i % 7), 0.19 + 1e-3 * (i % 5), 9.699 - 1e-3 * (i % 3), x * RAD, y * RAD, z * RAD))
        self.reads("nameless.csv", shape)
        _, said = typed(self.folder / "nameless.csv")
        assert "#2" not in said.split("to read it: ")[1], f"an acceleration is offered as a rate: {said}"
        _, said = typed(self.file("both.csv", self.rows(lambda i, x, y, z: (i / RATE_HZ, x, y, z, 3 * x, 3 * y, 3 * z))))
        assert "more than one column may be the rate" in said and "=#2:" in said and "=#5:" in said, said
        for name, header in (("attitude.csv", "t_s,w,x,y,z"), ("strokes.csv", "time_seconds,q_w,q_x,q_y,q_z"), ("pose.csv", "t_s,x,y,z,qx,qy,qz,qw"), ("rotation.csv", "t_s,rot_x,rot_y,rot_z,rot_w")):
            _, said = typed(self.file(name, [header, *self.rows(lambda i, x, y, z: (i / RATE_HZ, 0.9999, 0.001 * (i % 7), -0.002, 0.007, 0, 0, 0)[:len(header.split(","))])]))
            assert "no rate column among" in said, f"{name}: {said}"
        _, said = typed(self.file("acceleration.csv", ["Attribute,Time stamp,x,y,z", *self.rows(lambda i, x, y, z: ("Acceleration", 63156 + 5 * i, 0.12, 0.06, 1.02 + 1e-3 * (i % 5)))]))
        assert "no rate column among" in said, said
        rows = self.rows(lambda i, x, y, z: ("", "", f"{1729521988 + i // RATE_HZ}.0", f"{i % RATE_HZ * 5_000_000}.0", "", x, y, z))
        for i in range(ROWS - 1, 0, -RATE_HZ):
            rows.insert(i, f"{1729521988 + i // RATE_HZ}.0,0.0,,,42.3,,,")
        self.reads("outer_join.csv", ["timestamp_sec_gps,timestamp_nanosec_gps,timestamp_sec_imu,timestamp_nanosec_imu,latitude,gyro_x_dps,gyro_y_dps,gyro_z_dps", *rows],
                   unasked=True, says=("time 'timestamp_sec_imu+timestamp_nanosec_imu'", "20 rows without 'timestamp_sec_imu' are of another sensor and dropped"))
        self.reads("pedestrian.csv", ["GPST,Ax,Ay,Az,Gx,Gy,Gz", *self.rows(lambda i, x, y, z: (f"{390884.272 + i / RATE_HZ:.3f}", -1.8, -9.6, 1.4, x, y, z))], unasked=False)

    def check_stamps(self):
        header = "time_s,rate_x_radps"
        self.reads("packets.csv", [header, *self.rows(lambda i, x, y, z: (f"{0.03 + i // 7 * 0.035 + i % 7 * 1e-4:.6f}", x * RAD))], axes="x", says=("come in bursts", "at 200 Hz"))
        self.reads("windows.csv", [header, *self.rows(lambda i, x, y, z: (f"{i // 80 * 20 + i % 80 * 0.005:.6f}", x * RAD))], axes="x", says=())
        self.reads("same.csv", [header, *self.rows(lambda i, x, y, z: (f"{i // 7 * 0.035:.6f}", x * RAD))], axes="x", says=("come in bursts", "at 200 Hz"))
        rows = self.rows(lambda i, x, y, z: (f"{i / RATE_HZ:.3f}", x * RAD))
        self.reads("twice.csv", [header, *self.rows(lambda i, x, y, z: (f"{(i - (i % 37 == 36)) / RATE_HZ:.6f}", x * RAD))], axes="x", says=("have times as coarse as their steps", "at 200 Hz"))
        self.reads("repeated.csv", [header, *[row for i, row in enumerate(rows) for row in [row] * (2 if i % 80 == 5 else 1)]], axes="x", says=("50 rows repeat the row before",))
        self.reads("rollover.csv", ["t,gyro_x_dps", *self.rows(lambda i, x, y, z: ((4_294_000_000 + 5000 * i) % 2**32, x))], axes="x", says=("rolls over",))
        merged = [line for row in rows for line in (row + ",", *[f"{float(row.split(',')[0]) + k * 0.00125:.5f},,0.01" for k in (1, 2, 3)])]
        self.reads("merged.csv", ["time_s,rate_x_radps,accel_x_mps2", *merged], axes="x", says=("4000 of 16000 rows have a rate",))
        back = self.file("back.csv", [header, "0,0", "0.005,0", "0.003,0", "0.015,0"])
        assert ":3: time_s is 0.005 s" in typed(back)[1], typed(back)[1]

    def check_sensors_in_turn(self):
        path = self.file("turn.csv", ["time_s,sensor_id,rate_x_radps", *self.rows(lambda i, x, y, z: (i / RATE_HZ, i % 2, (x + i % 2) * RAD))])
        densities, said = typed(path)
        option = re.search(r"--only sensor_id=[^;\s]+", said)
        assert densities is None and option, said
        assert "--only 'sensor_id=*'" in said and typed(path, "--only", "sensor_id=*")[0], said
        densities, _ = typed(path, *shlex.split(option.group(0)))
        assert abs(densities["x"] / N * math.sqrt(0.5) - 1) < 0.07, densities  # half of the samples per second

    def check_rows_of_several_kinds_without_a_header(self):
        """From the first row on, wherever three of a kind stand in a row; with and without the option."""
        rows = [line for i, row in enumerate(self.rows(lambda i, x, y, z: (5 * i, "imu", x * RAD, y * RAD, z * RAD)))
                for line in ([row] if i > ROWS // 2 else [row, f"{5 * i},baro,100.1"])]
        path, to = self.file("kinds.csv", rows), self.folder / "kinds_read.csv"
        layout = ["--time", "#1:ms", *(word for i, a in enumerate("xyz") for word in ("--column", f"rate_{a}_radps=#{3 + i}:rad/s"))]
        for only in ((), ("--only", "#2=imu")):
            assert ran("convert", path, to, *layout, *only).returncode == 0
            lines = to.read_text().splitlines()
            assert len(lines) == ROWS + 1 and lines[1].startswith("0,"), (len(lines), lines[:3])
        assert "no column '#9'" in ran("convert", path, to, *layout, "--only", "#9=imu").stderr

    def check_what_the_values_say(self):
        def findings(name, rates, unit=RAD, rate_hz=RATE_HZ):
            path = self.file(name, ["time_s,rate_x_radps", *[f"{i / rate_hz:.6f},{v * unit!r}" for i, v in enumerate(rates)]])
            assert ran("allan", path, "--json", path.with_suffix(".json")).returncode == 0, name
            return {f["name"]: f["text"] for axis in json.loads(path.with_suffix(".json").read_text())["axes"] for f in axis["findings"]}

        noise = self.noise["x"]
        assert findings("good.csv", noise) == {}, findings("good.csv", noise)
        assert findings("coarse.csv", [round(v / SIGMA_DPS) * SIGMA_DPS for v in noise]) == {}
        coarse = [round(0.2 * v / SIGMA_DPS + 0.5) * SIGMA_DPS for v in noise]
        assert findings("two.csv", coarse) == {} and "below the resolution" in ran("allan", self.folder / "two.csv").stdout
        steps = random.Random(3).choices((-3, -1.5, 0, 1.5, 3), (9, 1, 80, 1, 9), k=ROWS)  # of a converter with two steps at once
        assert "clipped" not in findings("steps.csv", [v * SIGMA_DPS for v in steps])
        assert "5 times" in findings("held.csv", [v for v in noise for _ in range(5)], rate_hz=5 * RATE_HZ)["held"]
        stuck, full = list(noise), list(noise)
        for at in range(300, 3900, 400):
            stuck[at:at + 12], full[at:at + 12] = [stuck[at]] * 12, [9 * SIGMA_DPS] * 12
        assert all("12 samples, 9 times" in findings(f"{name}.csv", rates)["stuck"] for name, rates in (("stuck", stuck), ("full", full)))
        for command, name, lost in (("convert", "stuck", 0), ("denoise", "stuck", 0), ("convert", "full", 0), ("denoise", "full", 108)):
            assert ran(command, self.folder / f"{name}.csv", *["--output"] * (command == "denoise"), self.folder / "passed.csv").returncode == 0, command
            raw = [line.split(",")[1] for line in (self.folder / "passed.csv").read_text().splitlines() if line[:1].isdigit()]
            assert (len(raw), raw.count("nan")) == (ROWS, lost), (command, name)  # what only passes the rate on keeps what it can
        assert "clipped" in findings("clipped.csv", [min(v, 0.3 * SIGMA_DPS) for v in noise])
        lsb = 500 / 65536
        wrapped = self.file("wrapped.csv", ["time_s,rate_x_radps", *[f"{i / RATE_HZ:.6f},{round(v / lsb) % 65536 * lsb * RAD!r}" for i, v in enumerate(noise)]])
        assert "signed counts read as unsigned" in ran("allan", wrapped).stderr
        assert "interleaved" in findings("interleaved.csv", [v + 20 * SIGMA_DPS * (i % 2) for i, v in enumerate(noise)])
        assert "unit" in findings("unit.csv", [v + 500 for v in noise])

    def check_nothing_is_made_of_motion(self):
        """Of a gyro that was never at rest there is neither a figure nor a model."""
        dice, rate, rows = random.Random(8), 0.0, []
        for i in range(ROWS):
            rate = 0.999 * rate + dice.gauss(0, 0.3)
            rows.append(f"{i / RATE_HZ:.3f},{rate * RAD!r}")
        path = self.file("flying.csv", ["time_s,rate_radps", *rows])
        for command in ("allan", "tune", "diagnose"):
            said = ran(command, path)
            assert said.returncode == 1 and "at rest nowhere; expected a record that is mostly at rest" in said.stderr, (command, said)

    def check_slow_noise_that_is_a_channels_effect(self):
        """Twenty minutes in which 0.008 °/h/°C looks like a rate random walk. With a temperature that is not correlated, nothing
        is reported."""
        def found(name, temperature):
            dice, rows = random.Random(4), []
            for i in range(12_000):
                at = i / 10
                rows.append(f"{at:.1f},{(0.001 / 60 * math.sqrt(10) * dice.gauss(0, 1) + 0.008 / 3600 * 5 * math.sin(at / 150)) * RAD!r},{temperature(at):.2f}")
            path = self.file(name, ["time_s,rate_x_radps,temperature_degC", *rows])
            assert ran("allan", path, "--json", path.with_suffix(".json")).returncode == 0
            axis = json.loads(path.with_suffix(".json").read_text())["axes"][0]
            return axis["coefficients"]["K"], [f["text"] for f in axis["findings"] if "follow" in f["text"]]

        k, said = found("follows.csv", lambda at: 25 + 5 * math.sin(at / 150))
        assert len(said) == 1 and "temperature_degC" in said[0] and "run ifog diagnose" in said[0], said
        assert k["present"] and k["std_error"] > 0.9 * k["value"], k
        k, said = found("alone.csv", lambda at: 25 + 5 * math.sin(at / 9))
        assert k["present"] and said == [] and k["std_error"] < 0.5 * k["value"], (k, said)

    def check_real_sensors_at_rest_are_no_fault_of_a_logger(self):
        """Includes dithered ring lasers, whose samples alternate."""
        for name in ("ln100_x_up", "rlg_vehicle", "adis16405_imu3_1hz", "blueseis_bs1_ramp"):
            capture, to = CASES.parent / f"data/{name}.csv.gz", self.folder / "real.json"
            if not capture.exists():
                print(f"skipped  {name}: {capture} is not there")
                continue
            assert ran("allan", capture, "--json", to).returncode == 0, name
            found = [f["name"] for axis in json.loads(to.read_text())["axes"] for f in axis["findings"]]
            assert found == [], f"{name}: {found}"

    def check_ranges_of_a_dbc_file_are_information(self):
        """A signed rate with the range [0|100], as in public files: half of the values are outside, kept, counted and reported
        once with both numbers."""
        dbc, log, out = self.folder / "range.dbc", self.folder / "range.log", self.folder / "range.csv"
        dbc.write_text('VERSION ""\nBU_: A\nBO_ 291 M: 8 A\n SG_ Rate : 0|16@1- (0.01,0) [0|100] "deg/s" A\n SG_ Count : 16|8@1+ (1,0) [0|255] "" A\n')
        log.write_text("".join(f"({i * 0.01:.6f}) can0 123#{struct.pack('<hB', 5 * i - 500, i).hex()}0000000000\n" for i in range(200)))
        done = ran("convert", log, out, "--dbc", dbc, "--option", "signal=Rate", "--option", "counter=Count", "--option", "rate_hz=100")
        text = done.stdout + done.stderr
        assert done.returncode == 0 and text.count("100 values are beyond the range that their description states, and kept: Rate is -5, stated [0, 100]") == 1, text
        rates = [float(row.split(",")[1]) for row in out.read_text().splitlines() if row[0].isdigit()]
        assert len(rates) == 200 and abs(rates[0] + math.radians(5)) < 1e-12 and not any(map(math.isnan, rates)), rates[:3]

    def check_files_of_others(self):
        for path, axes, wanted, hz in () if not CASES.is_dir() else (("bias_column_suggested/log.csv", "x", 0.212, None), ("merged_rows_gyro_between_accel/merged.csv.gz", "x", 0.344, None),
                                       ("bursts_hilti/hilti.csv", "x", 0.688, None), ("counter_as_seconds/g370.csv", "x", 0.342, 200),
                                       ("increments_as_angle/vehicle_imu_0.csv.gz", "x", 0.344, None)):
            readings, said = by_hand(copy_of(CASES / path, self.folder), hz)
            assert any(abs(r[axes] / wanted - 1) < 0.05 for r in readings), f"{path}: {readings}, expected {wanted}: {said}"


def copy_of(path, folder):
    target = folder / path.name
    target.write_bytes(path.read_bytes())
    return target


if __name__ == "__main__":
    sys.exit(main_of(Checks))
