// SPDX-License-Identifier: Apache-2.0
// Files as other programs write them: what is read of each without options, or what is offered to type.
#include "tests/unit/capture/read_capture.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

TEST(OtherPrograms, FilesProgramsAreReadOrOfferedRight) {
  struct Case {
    std::string text;
    std::vector<std::string> said;
  };
  const std::vector<Case> cases = {
      // What names say is read without options, and what they leave open is asked for.
      {rows_of("Time [s],GyroX (deg/s),AccX (g),T\n", "0.{i},{x},2,3"),
       {"read as: time 'Time [s]' in s, rate_x 'GyroX (deg/s)' in deg/s, accx 'AccX (g)' in g\n"}},
      {rows_of("Time_s,Rate_radps,Temperature_degC,mode\n", "0.{i},{x},2,3"),
       {"time 'Time_s' in s, rate 'Rate_radps' in radps, temperature 'Temperature_degC' in degC\n"}},
      {rows_of("time_s,frame_rate_hz,gyro_x_dps,gyro_x_dps_std\n", "0.{i},2,{x},3"),
       {"time 'time_s' in s, rate_x 'gyro_x_dps' in dps\n"}},
      {rows_of("time_s,raw_x_radps,denoised_x_radps,T\n", "0.{i},{x},{x},3"),
       {"a.csv:1: no rate column among 'raw_x_radps', 'denoised_x_radps', 'T', expected 'rate_radps' or "}},
      // KAIST Complex Urban data set, fog.csv: a FOG's increments in rad.
      {rows_of("", "15445907980{i}0000000,{x},{y},{z}"),
       {"--time '#1:ns' --column 'rate_x_radps=#2:rad/s'",
        "; in the place of rad/s: deg/s, deg/h, rad/sample, deg/sample"}},
      // NCLT data set, kvh.csv: the heading of a FOG.
      {rows_of("", "13578472480{i}0000,{angle}"),
       {"--column 'rate_radps=#2:rad'", "in the place of rad: deg, rad/s"}},
      // Sensor Logger, Gyroscope.csv: a rate in motion is as smooth as an angle.
      {rows_of("time,seconds_elapsed,z,y,x\n", "1691674007{i}000000,1.{i},{angle},{y},{x}"),
       {"--column rate_z_radps=z:rad/s",
        "in the place of rad/s: deg/s, deg/h, rad/sample, deg/sample, rad, deg"}},
      // VectorNav, user manual, $VNIMU: magnetic field, acceleration, rates, temperature, pressure.
      {rows_of("", "$VNIMU,-0.0350,+0.4222,-0.6643,-0.015,+0.019,+9.80{digit},{x},{y},{z},+20.7,+84.322*00"),
       {"to read it: --sample-rate HZ --column rate_x_radps=gyro_x_radps:radps --column "
        "rate_y_radps=gyro_y_radps:radps --column rate_z_radps=gyro_z_radps:radps --column mag_x"}},
      // The same, $VNYMR: angles, magnetic field, acceleration, rates, which a checksum follows.
      {rows_of("",
               "$VNYMR,-165.9,-037.2,+001.2,+0.289,+0.070,+0.748,-05.96,-00.18,-07.7{digit},{x},{y},{z}*69"),
       {"a.csv:1: no time column; to read it: --sample-rate HZ --column rate_x_radps=gyro_x_radps:radps"}},
      // A reference of one axis under the capture's name.
      {rows_of("t_s,rate_radps,reference_rate_radps\n", "0.{i},{x},{y}"),
       {"reference_rate 'reference_rate_radps' in radps"}},
      // A rate table beside a sensor of one axis, in the table's unit.
      {rows_of("time_s,gyro_x_dps,table_rpm\n", "0.{i},{x},{digit}.5"),
       {"reference_rate_x 'table_rpm' in rpm"}},
      {rows_of("time_s,rate_dps,Turntable rate Z (deg/s)\n", "0.{i},{x},{digit}.5"),
       {"reference_rate 'Turntable rate Z (deg/s)' in deg/s"}},
      // A rate table's angle is differentiated; what commands it, and what has no known unit, is told and not read.
      {rows_of("t_s,table_angle_deg,gyro_z_deg_s\n", "0.{i},{angle},{z}"),
       {"reference_rate_z 'table_angle_deg' in deg (an angle, by its differences)"}},
      {rows_of("Time (s),Commanded rate (deg/s),Gyro output (deg/s),Humidity [%],Lamp,Temp (degC),Temp [K]\n",
               "0.{i},0,{x},40,3,25,298"),
       {"rate 'Gyro output (deg/s)' in deg/s, humidity 'Humidity [%]' in %, temp 'Temp (degC)' in degC, "
        "temp_7 'Temp [K]' in K\n",
        "not read: 'Commanded rate (deg/s)', 'Lamp'; as the true rate: --time 'Time (s):s' "
        "--column "
        "'rate_radps=Gyro output (deg/s):deg/s'",
        "--column 'reference_rate_radps=Commanded rate (deg/s):deg/s'"}},
      // A unit of angle in a name that says nothing of an angle, an angle by name, and one that no gyro is named with.
      {rows_of("time_s,gyro_z [deg]\n", "0.{i},{z}"),
       {"'gyro_z [deg]' has a unit of angle, as a rate, an angle or the turn in each sample may; to read it: "
        "--column 'rate_z_radps=gyro_z [deg]:deg/s'; in the place of deg/s: deg, deg/sample"}},
      {rows_of("time_s,Gyro angle Z (deg)\n", "0.{i},{z}"), {"rate_z 'Gyro angle Z (deg)' in deg (an angle"}},
      {rows_of("time_s,angle_z [arcsec]\n", "0.{i},{z}"),
       {"--column 'rate_z_radps=angle_z [arcsec]:arcsec'; in the place of arcsec: arcsec/s, arcsec/sample"}},
      // A time without a unit: what is supposed is said, and a slow log that it may be as well.
      {rows_of("time,gyro_z_dps\n", "1{i}0,{z}"),
       {"time 'time' in ms (not named; gives 100 Hz; 0.1 Hz if it is in s: --time time:s), rate_z"}},
      {rows_of("time,gyro_z_dps\n", "0.{i},{z}"), {"time 'time' in s (not named; gives 1000 Hz), rate_z"}},
      // PX4's replay without names: rows of several kinds from the first one on.
      {"1000,imu,0.001,0.002,0.003\n1000,baro,100.1\n" + rows_of("", "2{i},imu,{x},{y},{z}\n2{i},mag,0.2"),
       {"of rows of several kinds are read those of --only '#2=imu'; no time",
        "--column 'rate_x_radps=#3:rad/s'"}},
      // Typographic minus signs, exponents of Fortran, a sentence above the rows, a second gyro, a name in another language.
      {rows_of("time_s,gyro_z_dps\n", "0.{i},\u22120.00{digit}"), {"rate_z 'gyro_z_dps' in dps"}},
      {rows_of("  TIME(S)  WX(RAD/S)\n", "  1.0{i}D-02  8.73{digit}D-04", 80),
       {"time 'TIME(S)' in S, rate_x 'WX(RAD/S)' in RAD/S"}},
      {rows_of("Project: 7\nSampling rate: 100 Hz\n", "0.{i},{x},{y},{z}"),
       {"no header line", "--column 'rate_x_radps=#2:rad/s'"}},
      {rows_of("ax2,gx2,gy2,gz2\n", "9.8,{x},{y},{z}"), {"--column rate_x_radps=gx2:rad/s"}},
      {rows_of("Время, с;Угловая скорость, град/ч\n", "0,{i};{digit},5"),
       {"rate 'Угловая скорость, град/ч' in град/ч"}},
      // OxIOD data set, imu.csv: roll, pitch, yaw, rates, gravity.
      {rows_of("", "1505306516.{i},0.01,0.02,{angle},{x},{y},{z},0.1,0.2,0.97"),
       {"--column 'rate_x_radps=#5:rad/s' --column 'rate_y_radps=#6:rad/s' --column 'rate_z_radps=#7:rad/s'; "
        "in"}},
      // Analog Devices, ADIS16495 data logger: registers.
      {rows_of("Timestamp,X_GYRO_OUT\n", "0.{i},{count}"),
       {"whole numbers are often counts", "--column rate_x_radps=X_GYRO_OUT:0.005deg/s"}},
      // Axes counted from 1, as in MATLAB and R, or from 0; four numbers are sensors.
      {rows_of("time_s,gyro1_dps,gyro2_dps,gyro3_dps,acc_1_g\n", "0.{i},{x},{y},{z},1"),
       {"rate_x 'gyro1_dps' in dps, rate_y 'gyro2_dps' in dps, rate_z 'gyro3_dps' in dps, acc_1"}},
      {rows_of("t (s),gyro[1] (rad/s),gyro[2] (rad/s),gyro[3] (rad/s)\n", "0.{i},{x},{y},{z}"),
       {"rate_x 'gyro[1] (rad/s)' in rad/s, rate_y 'gyro[2] (rad/s)' in rad/s, rate_z 'gyro[3] (rad/s)'"}},
      {rows_of("t,g1,g2,g3\n", "0.{i},{x},{y},{z}"),
       {"--column rate_x_radps=g1:rad/s --column rate_y_radps=g2:rad/s --column rate_z_radps=g3:rad/s"}},
      {rows_of("t_s,rate1_dps,rate2_dps\n", "0.{i},{x},{y}"),
       {"rate_x 'rate1_dps' in dps, rate_y 'rate2_dps'"}},
      {rows_of("t_s,w0_dps,w1_dps\n", "0.{i},{x},{y}"), {"rate_x 'w0_dps' in dps, rate_y 'w1_dps'"}},
      {rows_of("t_s,gyro1_dps,gyro2_dps,gyro3_dps,gyro4_dps\n", "0.{i},{x},{y},{z},{x}"),
       {"more than one column may be the rate; to read it: --time t_s:s --column rate_radps=gyro1_dps:dps; "
        "or: "
        "--time t_s:s --column rate_radps=gyro2_dps:dps; or: "}},
      // KITTI's oxts begins with a latitude, and a filter's output with a number of the row: none is a time in days.
      {rows_of("", "49.00000{i} 8.4 {x} {y} {z}"),
       {"no time column; to read it: --sample-rate HZ --column 'rate_x_radps=#3:rad/s'"}},
      {rows_of("", "{i} -0.00001{i} {x} {y}"),
       {"no time column, '#1' counts the rows; to read it: --sample-rate"}},
      // Axes under names of their own are offered in the order of the columns, and one by one.
      {rows_of("t_s,gyro_fwd_dps,gyro_right_dps,gyro_down_dps\n", "0.{i},{x},{y},{z}"),
       {"to read it: --time t_s:s --column rate_x_radps=gyro_fwd_dps:dps --column "
        "rate_y_radps=gyro_right_dps:dps "
        "--column rate_z_radps=gyro_down_dps:dps; or: --time t_s:s --column rate_radps=gyro_fwd_dps:dps; "
        "or:"}},
      {rows_of("t_s,omega_p,omega_q,omega_r\n", "0.{i},{x},{y},{z}"),
       {"--column rate_z_radps=omega_r:rad/s; or:"}},
      {rows_of("t_s,GyroA,GyroB,GyroC\n", "0.{i},{x},{y},{z}"), {"--column rate_z_radps=GyroC:rad/s; or:"}},
      {rows_of("t_s,Axis1 Rate (deg/s),Axis2 Rate (deg/s),Axis3 Rate (deg/s)\n", "0.{i},{x},{y},{z}"),
       {"--column 'rate_z_radps=Axis3 Rate (deg/s):deg/s'; or:"}},
      // Laser gyro test stands write the arcsecond's sign.
      {rows_of("Time [s]; Rate X [\"/s]\n", "0.{i}; {x}"), {"rate_x 'Rate X [\"/s]' in \"/s"}},
      // A laboratory's logger: three temperatures below one name, and names of sensors that are switched off.
      {rows_of("time,wx,T,yaw\n", "0.{i},{x},40.0{digit},41.4{digit},38.2{digit},0.5"),
       {"a.csv:1: the header has 4 names and the rows have 6 cells, #1 to #6; no name surely stands above "
        "its column; --column 'rate_x_radps=#2:deg/s' and --time '#1:s' or"}},
      {rows_of("time,wx,T,yaw\n", "0.{i},{x},0.5"), {"the header has 4 names and the rows have 3 cells"}},
      // MATLAB datenum and Excel serial dates: days.
      {rows_of("time,gyro_x_dps\n", "738856.500{i}57858,{x}"), {"read as: time 'time' in d"}},
      {rows_of("time_days,gyro_x_dps\n", "0.00000{i},{x}"), {"read as: time 'time_days' in d"}},
      // A rocket's logger, and units in words.
      {rows_of("timestamp_seconds,raw_angular_rate_x_deg_per_s,rate_y_degrees_per_second,Gyro Z rad per s\n",
               "0.{i},{x},{y},{z}"),
       {"rate_x 'raw_angular_rate_x_deg_per_s' in deg_per_s, rate_y 'rate_y_degrees_per_second' in "
        "degrees_per_second, rate_z 'Gyro Z rad per s' in rad per s"}},
      // A unit behind a comma (GOST 2.105) or "in" (DIN 461), or as a divisor; a minimum is no minute.
      {rows_of("Время, с;Угловая скорость X, град/с\n", "0.{i};{x}"),
       {"rate_x 'Угловая скорость X, град/с' in град/с"}},
      {rows_of("Zeit in s;Drehrate X in °/s;y (in radians/s)\n", "0.{i};{x};{y}"),
       {"rate_x 'Drehrate X in °/s' in °/s, rate_y 'y (in radians/s)' in radians/s"}},
      {rows_of("Time / s;Gyro X / deg/s;Gyro X min\n", "0.{i};{x};{y}"),
       {"rate_x 'Gyro X / deg/s' in deg/s"}},
      // Movella DOT data exporter: the stated rate tells that its clock is of us.
      {rows_of("sep=,\nDeviceTag:,DOT1\nOutputRate:,100Hz\nPacketCounter,SampleTimeFine,Gyr_X\n",
               "{i},3{i}0000,{x}"),
       {"--time SampleTimeFine:us"}},
      // The same without a stated rate (MoRPINet, raw_imu_g_4.csv), and an MTi, whose clock is of 100 us.
      {rows_of("sep=,\nPacketCounter,SampleTimeFine,Gyr_X\n", "{i},3{i}0000,{x}"),
       {"--time SampleTimeFine:us"}},
      {rows_of("PacketCounter,SampleTimeFine,Gyr_X\n", "{i},3{i}00,{x}"), {"--time SampleTimeFine:100us"}},
      // TEX-CUP data set: week, second, fraction of the second.
      {rows_of("", "2051 240000 0.{i} {x} -0.0475 9.808 {x} {y} {z}"),
       {"--sample-rate HZ --column 'rate_x_radps=#7:"}},
      // Malaga data set, MRPT: the header begins with %.
      {rows_of("%  Time  IMU_YAW_VEL  IMU_PITCH_VEL  IMU_ROLL_VEL\n", " 1261228426.{i} {z} {y} {x}"),
       {"--time Time:s --column rate_z_radps=IMU_YAW_VEL:rad/s"}},
      // NovAtel OEM7, abbreviated ASCII log RAWIMUSXA among others.
      {rows_of("#BESTPOSA,COM1,0,72.0;SOL_COMPUTED,SINGLE,51.11*3c6da5d7\n",
               "%RAWIMUSXA,2075,507495.{i};00,13,2075,507495.165000000,00000000,32068,-1612,-1320,{count},-{"
               "i},1{i}*3c6da5d7"),
       {"whose scale is in the sensor's manual: --column rate_x_radps=dtheta_x:1e-9rad/sample",
        "--column rate_z_radps=dtheta_z:rad/sample --column rate_y_radps=dtheta_minus_y:-1rad/sample "
        "--column "
        "rate_x_radps=dtheta_x:rad/sample"}},
      {rows_of("",
               "#RAWIMUSA,2075,507495.{i};2075,507495.{i}000000,00000077,32068,-1612,-1320,{count},-{i},1{i}*"
               "3c6da5d7"),
       {"--time tow_s:s --column rate_z_radps=dtheta_z:rad/sample"}},
      // Records of several kinds in one file, whose names another line states: GnssLogger, ArduPilot.
      {rows_of("# UncalAccel,utcTimeMillis,elapsedRealtimeNanos,UncalAccelXMps2\n"
               "# UncalGyro,utcTimeMillis,elapsedRealtimeNanos,UncalGyroXRadPerSec,UncalGyroYRadPerSec,"
               "UncalGyroZRadPerSec,DriftXRadPerSec,DriftYRadPerSec,DriftZRadPerSec\n",
               "UncalGyro,1690000000{i},8123{i}000000,{x},{y},{z},0.0,0.0,0.0\nUncalAccel,1690000000{i},8123{"
               "i}000001,9.8"),
       {"rate_x 'UncalGyroXRadPerSec' in RadPerSec", "time 'elapsedRealtimeNanos' in ns"}},
      {rows_of("FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n"
               "FMT, 140, 43, IMU, QBffffff, TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ\n",
               "IMU, 123{i}000, 0, {x}, {y}, {z}, 0.1, 0.2, -9.8\nATT, 123{i}001, 0.1, 0.2"),
       {"--time TimeUS:us --column rate_x_radps=GyrX:rad/s"}},
      // Names over two lines, the units in a third; a line of types below the names.
      {rows_of("Time,Gyro,,,Accel,,\n,x,y,z,x,y,z\ns,deg/s,deg/s,deg/s,m/s2,m/s2,m/s2\n",
               "0.{i},{x},{y},{z},0.1,0.2,9.8"),
       {"time 'Time' in s, rate_x 'Gyro x' in deg/s, rate_y 'Gyro y' in deg/s, rate_z 'Gyro z' in deg/s"}},
      {rows_of("t_s,gyro_x_dps\nfloat64,float32\n", "0.{i},{x}"), {"rate_x 'gyro_x_dps' in dps"}},
      // Names in other encodings than UTF-8: Windows' Cyrillic and Western ones, GBK.
      {rows_of("time_ms,\xC3\xE8\xF0\xEE gyro_x (deg/s)\n", "1{i},{x}"), {"rate_x '#2' in deg/s"}},
      {rows_of("time [s],\xCD\xD3\xC2\xDD gyro z [\xA1\xE3/s]\n", "0.{i},{z}"), {"rate_z '#2' in deg/s"}},
      {rows_of("\xC2\xF0\xE5\xEC\xFF (\xF1),X (\xE3\xF0\xE0\xE4/\xF1)\n", "0.{i},{x}"),
       {"time '#1' in s, rate_x '#2' in deg/s"}},
      // Rows and lines of several sensors: those that are called a gyro's are read.
      {rows_of("sensor,time_s,x,y,z\n", "Gyroscope,0.{i},{x},{y},{z}\nAccelerometer,0.{i},0.1,0.2,9.8"),
       {"--column rate_x_radps=x:rad/s"}},
      {rows_of("",
               "{\"type\":\"gyro\",\"t\":0.{i},\"x\":{x},\"y\":{y},\"z\":{z}}\n{\"type\":\"acc\",\"t\":0.{i},"
               "\"x\":9.8,"
               "\"y\":0,\"z\":0}"),
       {"--time t:s --column rate_x_radps=x:rad/s --column rate_y_radps=y:rad/s"}},
      {rows_of("timestamp,xyz[0],xyz[1],xyz[2]\n", "1{i}000,{x},{y},{z}"),
       {"--column 'rate_x_radps=xyz[0]:rad/s'"}},
      // An oscilloscope: channels called by their numbers.
      {rows_of("x-axis,1,2\nsecond,Volt,Volt\n", "0.{i},{x},{y}"),
       {"no rate column among 'x-axis', '1', '2'"}},
      // SensorLog: a time of each sensor, which its other rows lack, and columns without any value.
      {rows_of("loggingTime,gpsTimestamp_since1970,gyroTimestamp_sinceReboot,gyroRotationX,motionTimestamp_"
               "sinceReboot,motionRotationRateX\n",
               "2016-08-09 13:09:51.{i},,254988.{i},{x},,\n2016-08-09 13:09:51.{i}5,1470740990.{i},,,,"),
       {"--time gyroTimestamp_sinceReboot:s --column rate_x_radps=gyroRotationX:rad/s; in"}},
      // RepoIMU: a row of axes whose first cell is a unit.
      {rows_of("Time;Vicon;;;;IMU Gyroscope;;\ns;W;X;Y;Z;X;Y;Z\n", "0.{i};1;0.1;0.2;0.3;{x};{y};{z}"),
       {"--time Time:s --column 'rate_x_radps=IMU Gyroscope X:rad/s'"}},
      {rows_of("Time,KX_IMU_ax,IMU_gx,IMU_gy\n", "0.{i},1.0,{x},{y}"),
       {"--time Time:s --column rate_x_radps=IMU_gx:rad/s --column rate_y_radps=IMU_gy:rad/s"}},
      {rows_of("lowG_data.timeStamp_lowG,lowG_data.ax,lowG_data.gx\n", "194{i}000,1.0,{x}"),
       {"--time lowG_data.timeStamp_lowG:ms --column rate_x_radps=lowG_data.gx:rad/s"}},
      // A matrix of MATLAB 7.3: time and rates in one.
      {rows_of("buffer[0],buffer[1],buffer[2],buffer[3]\n", "0.{i},{x},{y},{z}"),
       {"--time 'buffer[0]:s' --column 'rate_x_radps=buffer[1]:rad/s' --column "
        "'rate_y_radps=buffer[2]:rad/s'"}},
      // Only units in which a sensor may measure the values are offered.
      {rows_of("timestamp,imu.gyro.x\n", "25655{i}491968,{x}"),
       {"--time timestamp:us", "in the place of us: ns;"}},
      {rows_of("t_s,gyro_x\n", "0.{i},32{i}"), {"gyro_x:deg/s; in the place of deg/s: deg/h, rad/sample"}},
      // NovAtel SPAN without inertial logs.
      {rows_of("",
               "#INSATTA,USB3,0,68.5;1992,2363{i}.0,0.{i},0.1,0.2*8498a2b3\n#BESTVELA,USB3,0,68.5;SOL_"
               "COMPUTED,0.{i},0.2,0.{i}*042fe272"),
       {"logs of NovAtel without rates, expected RAWIMUS"}},
      // Text that is no table says what makes one.
      {"[{\"sensor\":\"Gyroscope\",\"time\":\"1\",\"x\":\"0.1\"},{\"sensor\":\"Accelerometer\",\"time\":"
       "\"1\",\"x\":\"9\"}]",
       {"is JSON of several sensors", "jq -r '.[] | select(.sensor == \"Gyroscope\")"}},
      {"TIMESERIES XX_GYRO__HJZ_M, 12 samples, 20 sps, 2023-01-01T00:00:00.000000, SLIST, INTEGER, Counts\n1 "
       "2 3 4 5 6\n",
       {"is SLIST with several samples a line"}},
      // NI LabVIEW measurement file: two heads, a decimal comma, a name without cells.
      {rows_of("LabVIEW Measurement\t\nSeparator\tTab\n***End_of_Header***\t\n\nChannels\t1\nSamples\t40\n"
               "Y_Unit_Label\tdeg/s\nDelta_X\t0,010000\n***End_of_Header***\t\nX_Value\tGyro X\tComment\n",
               "0,{i}000\t0,{i}"),
       {"time 'X_Value' in s, rate_x 'Gyro X' in deg/s"}},
      // Spreadsheets: one name over three columns.
      {rows_of("time (s),gyro,gyro,gyro\n", "0.{i},{x},{y},{z}"),
       {"--column 'rate_x_radps=#2:rad/s' --column 'rate_y_radps=#3:rad/s' --column "
        "'rate_z_radps=#4:rad/s'"}},
      // GoPro telemetry extractor: the axis stands in brackets, and z first.
      {rows_of("t [s],Gyroscope (z) [rad/s],Gyroscope (x) [rad/s]\n", "0.{i},{z},{x}"),
       {"rate_z 'Gyroscope (z) [rad/s]' in rad/s, rate_x 'Gyroscope (x) [rad/s]' in rad/s"}},
      // x-IMU GUI, CalInertialAndMag.csv: G is gauss.
      {rows_of("Packet number,Gyroscope X (deg/s),Magnetometer X (G)\n", "{i},{x},0.21"),
       {"--column 'magnetometer_x_uT=Magnetometer X (G):gauss'"}},
      // A PX4 module that logs its gyro and a FOG.
      {rows_of("Timestamp,Gyro_X,FOG_X\n", "1{i}0000,{x},{y}"),
       {"rate_x_radps=Gyro_X", "rate_x_radps=FOG_X"}},
      // rostopic echo, and loggers that write objects in objects.
      {"header: \n  seq: 0\n---\nheader: \n  seq: 1\n---\n", {"rostopic echo -p"}},
      {rows_of("", R"({"ts": 17.{i}, "gyro": {"x": {x}, "y": {y}, "z": {z}}})"), {"jq -r"}},
      // Gyroflow, gcsv 1.3, whose head looks like a table, and Epson's logger: the scale of counts stands above.
      {rows_of(
           "GYROFLOW IMU LOG\nid,custom\nvendor,cam\nversion,1.3\ntscale,0.001\ngscale,0.00122\nt,gx,gy,gz\n",
           "{i},{count},{count},{count}"),
       {"read as: time 't' in 0.001s, rate_x 'gx' in 0.00122 rad/s, rate_y 'gy' in 0.00122 rad/s"}},
      {rows_of("Gyro_SF=0.0151515 Accel_SF=0.4\nSample No,time,Gx,Gy\n", "{i},1.{i},{count},{count}"),
       {"rate_x 'Gx' in 0.0151515 deg/s"}},
      // Sensor Logger, a list of objects.
      {rows_of(
           "",
           R"({"sensor": "Gyroscope", "time": "17676204673{i}0000000", "x": "{x}", "y": "{y}", "z": "{z}"},)"),
       {"--time time:ns --column rate_x_radps=x:rad/s --column rate_y_radps=y:rad/s"}},
      // yoos/kvh_1750_troubleshooting, kvh_direct_imu_rate.log: labels before the last values only.
      {rows_of("", " 1 {i} {i}  0b1110111    rate (rad):  {x}  {y}  {z}   angle (deg):  {x}  {y}  {z}"),
       {"'#2' counts the rows; to read it: --sample-rate HZ --column 'rate_x_radps=rate (rad)_x:rad/s'"}},
      // Of overlapping triples those are offered whose columns are alike.
      {rows_of("", "0.{i},{count}.5,{x},{y},{z},{angle}"),
       {"#1 to #6; the unit of the rate is not named", "=#3:rad/s' --column 'rate_y_radps=#4:rad/s'"}},
      // Spreadsheets: marks of thousands, minutes and seconds of an hour that ends, and two recordings in one file.
      {rows_of("time_ms,gyro_x_dps\n", "\"1,{i},000.5\",{x}"), {"time 'time_ms' in ms, rate_x"}},
      {rows_of("time_ms;gyro_x_dps\n", "7.{i},5;0,0{digit}"), {"time 'time_ms' in ms, rate_x"}},
      {rows_of("time,gyro_x_dps\n", "59:59.{i},{x}") + rows_of("", "00:00.{i},{x}"),
       {"time 'time' in s", "a.csv:42: time rolls over, as an hour does"}},
      {rows_of("time_s,rate_radps\n", "0.{i},{x}") + rows_of("", "0.{i},{x}"),
       {"a.csv:42: time_s begins again at 0.1 s, as after a clock was set or"}},
      {rows_of("time_s,rate_radps\n", "0.{i},{x}", 600) + rows_of("", "0.5{i},{x}"),
       {"a.csv:602: time_s begins again at 0.51 s, as after a clock was set or"}},
      // A buffer that was not filled; rows of one time whose other cells differ, or only another clock.
      {rows_of("time_s,rate_radps\n", "0.{i},{x}", 600) + rows_of("", "0,0"),
       {"39 rows repeat the row before"}},
      {rows_of("t (s),gx (deg/s),b\n", "0.{i},0.{i},{x}", 300) + "0.5,0.7,1\n0.5,0.7,2\n0.6,0,3\n",
       {"1 rows have the time of the row before"}},
      {rows_of("t (s),gx (deg/s),n\n", "0.{i},0.{i},{i}", 300) + "0.5,0.7,400\n0.5,0.7,401\n0.6,0,402\n",
       {"1 row repeats the row before"}},
      // Thousands by the other column; Microsoft's NaN; whole seconds of many rows.
      {rows_of("# sample rate 1000\ntime;gz (deg/h)\n", "{i},000;4,3{digit}4.5"),
       {"'time' in us, rate_z 'gz"}},
      {rows_of("t (s),gz (deg/s)\n0.01,-1.#IND\n", "0.{i},{x}"), {"read as: time 't (s)' in s, rate_z"}},
      {rows_of("t (s),gz (deg/s)\n", "7,{x}", 99) + rows_of("", "8,{x}", 99) + "9,0\n",
       {"read as: time 't (s)' in s, rate_z"}},
      // Ticks of a timer are of unknown length, unless they count the rows.
      {rows_of("ticks,gyro_x_dps\n", "8{i}000,{x}"),
       {"the unit of the time is not named; a tick may have any length: --time ticks:62.5ns; to read it: "
        "--time "
        "ticks:ms --column rate_x",
        "in the place of ms: us, ns, s"}},
      {rows_of("tick,gyro_x_dps\n", "{i},{x}"), {"no time column, 'tick' counts the rows"}},
      // A colon before the milliseconds.
      {rows_of("time,gyro_x_dps\n", "12:00:00:{i},{x}"),
       {"read as: time 'time' in s, rate_x 'gyro_x_dps' in dps"}},
      // ArduPilot, IMT: delta angles over DelaT, beside delta velocities; rates in the body's frame; a matrix "rot".
      {rows_of("TimeUS,DelT,DelvT,DelaT,DelAX,DelAY,DelAZ,DelVX\n",
               "1{i}000,0.001,0.001,0.001,{x},{y},{z},0.1"),
       {"rate_x 'DelAX' in rad/sample, rate_y 'DelAY' in rad/sample, rate_z 'DelAZ' in rad/sample"}},
      {rows_of("t_s,wb_x,wb_y,wb_z,x,y,z\n", "0.{i},{x},{y},{z},1,2,3"),
       {"--column rate_x_radps=wb_x:rad/s --column rate_y_radps=wb_y:rad/s"}},
      {rows_of("t_s,rot0,rot1,rot2\n", "0.{i},{x},{y},{z}"), {"--column rate_x_radps=rot0:rad/s --column"}},
      {"$GPGGA,1,2*00\n$GPRMC,1,2*00\n", {"is NMEA 0183 of a GNSS receiver, which has no rate"}},
      {"time_s,rate_radps\n5,0\n4,0\n3,0\n2,0\n", {"a.csv:3: time_s is 4 s", "written backwards: 'tac'"}},
      // Spreadsheets of both orders.
      {rows_of("time,gyro_x_dps\n", "05/06/2023 12:00:00.{i},{x}"), {"read with the month first"}},
  };
  for (const Case& each : cases) {
    std::string all;
    try {
      for (const std::string& notice : parse_capture(each.text, "a.csv").notices) all += notice + "\n";
    } catch (const std::runtime_error& error) {
      all = error.what();
    }
    for (const std::string& part : each.said)
      EXPECT_TRUE(test::has(all, part)) << part << "\nnot in\n"
                                        << all << "\nof\n"
                                        << each.text.substr(0, 300);
  }
}

TEST(OtherPrograms, WholeNumbersNameASensorAndMeasuredValuesDoNot) {
  for (const auto& [name, one, other, are_sensors] :
       std::initializer_list<std::tuple<const char*, const char*, const char*, bool>>{
           {"imu", "0", "1", true},
           {"imu_temperature_degC", "25.1", "25.2", false},
           {"imu_gyr[1]", "-0.00106", "0.00213", false},
           {"imu_gyr[1]", "3", "4", false}}) {
    std::string text = "time_s,rate_radps," + std::string(name) + "\n";
    for (int i = 0; i < 40; ++i)
      text += std::to_string(i) + ",0.00" + std::to_string(i) + "," + (i % 2 == 0 ? one : other) + "\n";
    std::string all;
    try {
      (void)parse_capture(text, "a.csv");
    } catch (const std::runtime_error& error) {
      all = error.what();
    }
    EXPECT_EQ(all.find("rows of several sensors") != std::string::npos, are_sensors) << name << one;
  }
}

// Whole seconds as stamps, five rows each, the first and the last second being cut: no row is taken for a repeat of
// the one before because coarse values are often equal, and all are as far apart.
TEST(OtherPrograms, CoarseValuesUnderCoarseStampsAreNoRepeats) {
  for (const bool doubled : {false, true}) {
    std::string text = "time_s,rate_radps\n";
    std::uint32_t dice = 1;
    for (int i = 3; i < 998; ++i) {
      dice = dice * 1664525U + 1013904223U;
      for (int times = 0; times < (doubled ? 2 : 1); ++times)
        text += std::to_string(i / 5) + ",0.00" + std::to_string(dice >> 30U) + "\n";
    }
    const Capture read = parse_capture(text, "a.csv");
    if (doubled) {
      EXPECT_LT(read.size(), 1000U);
      continue;
    }
    ASSERT_EQ(read.size(), 995U);
    for (std::size_t i = 0; i < read.size(); ++i)
      EXPECT_NEAR(read.time_s[i], 0.2 * static_cast<double>(i + 3), 1e-9);
  }
}

// A day above 12 says the order of all rows; one that contradicts it later is no row.
TEST(OtherPrograms, RowsDecideWhatIsTheDay) {
  const auto read = [](const std::string& day, const std::string& next) {
    return parse_capture(
        rows_of("t,gyro_x_dps\n", day + " 23:59:59.{i},{x}", 400) + next + " 00:00:00.1,0.1\n", "a.csv");
  };
  EXPECT_EQ(read("13/06/2023", "14/06/2023").origin.s, 1686700799);
  EXPECT_EQ(read("13/06/2023", "14/06/2023").faults.size() + read("2023-06-12", "2023-06-13").faults.size(),
            0U);
  EXPECT_EQ(read("12/06/2023", "13/06/2023").faults.size(), 1U);
  CsvLayout given;
  given.time = CsvTime::parse("t:d/m/y");
  given.columns = {CsvColumn::parse("rate_radps=w:rad/s")};
  const char* const rows = "t,w\n5/6/2023 00:00:00,0.5\n5/6/2023 00:00:01,0.5\n";
  EXPECT_EQ(parse_capture(rows, "a.csv", given).origin.s, 1685923200);
}

}  // namespace
}  // namespace ifog
