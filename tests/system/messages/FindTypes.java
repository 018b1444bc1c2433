// SPDX-License-Identifier: Apache-2.0
import java.io.File;
import java.util.HashSet;
import java.util.Set;
import java.util.jar.JarFile;

/** Every type of the jar, found as lcm-spy finds it: a class with a static LCM_FINGERPRINT, looked up by it. */
public class FindTypes {
  public static void main(String[] arguments) throws Exception {
    lcm.spy.LCMTypeDatabase types = new lcm.spy.LCMTypeDatabase();
    Set<String> wanted = new HashSet<>(Set.of("ifog.rate_t", "ifog.status_t", "ifog.imu_t", "ifog.inertial_t", "ifog.channel_t"));
    for (String path : System.getProperty("java.class.path").split(File.pathSeparator)) {
      if (!path.contains("ifogd-msgs")) continue;
      for (String entry : new JarFile(path).stream().map(Object::toString).filter(name -> name.endsWith(".class")).toList()) {
        Class<?> type = Class.forName(entry.substring(0, entry.length() - 6).replace('/', '.'));
        long fingerprint = type.getField("LCM_FINGERPRINT").getLong(null);
        if (types.getClassByFingerprint(fingerprint) != type) throw new Exception(type + " is not found by its hash");
        wanted.remove(type.getName());
        System.out.printf("%s %016x%n", type.getName(), fingerprint);
      }
    }
    if (!wanted.isEmpty()) throw new Exception("not in the jar: " + wanted);
    System.exit(0);
  }
}
