# Untried: written by nixpkgs' documentation, on a machine without Nix. From the sources' folder:
# nix-build -E '(import <nixpkgs> { }).callPackage ./dist/tactpad.nix { }'; in configuration.nix:
# services.udev.packages = [ tactpad ]; systemd.packages = [ tactpad ]; hardware.uinput.enable = true;
{ lib, rustPlatform, installShellFiles }:

rustPlatform.buildRustPackage {
  pname = "tactpad";
  version = (lib.importTOML ../Cargo.toml).workspace.package.version;
  src = lib.cleanSource ../.;
  cargoLock.lockFile = ../Cargo.lock;
  buildType = "dist";
  # The tests need pads, guests and browsers.
  doCheck = false;
  nativeBuildInputs = [ installShellFiles ];
  postInstall = ''
    install -D -m 644 docs/linux/70-tactpad.rules -t $out/lib/udev/rules.d
    sed "s|%h/.cargo/bin|$out/bin|" docs/linux/tactpad.service >tactpad.service
    install -D -m 644 tactpad.service -t $out/lib/systemd/user
    install -D -m 644 docs/linux/tactpad.desktop -t $out/share/applications
    install -D -m 644 docs/linux/tactpad.svg -t $out/share/icons/hicolor/scalable/apps
    for shell in bash zsh fish; do $out/bin/tactpad completions $shell >tactpad.$shell; done
    installShellCompletion tactpad.{bash,zsh,fish}
  '';
  meta = {
    description = "Turns a tactile disc with nine strain channels into a game controller";
    license = with lib.licenses; [ mit asl20 ];
    platforms = lib.platforms.linux;
    mainProgram = "tactpad";
  };
}
