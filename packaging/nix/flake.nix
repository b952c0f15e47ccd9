# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
# nix build "git+file://CLONE?dir=packaging/nix"
# The clone that holds the flake is the source.
{
  description = "Certified sphere trees for deforming triangle meshes";

  inputs.nixpkgs.url = "github:NixOS/nixpkgs/nixos-25.05";

  outputs = { self, nixpkgs }:
    let
      systems = [ "x86_64-linux" "aarch64-linux" "x86_64-darwin" "aarch64-darwin" ];
      each = build: nixpkgs.lib.genAttrs systems (system: build nixpkgs.legacyPackages.${system});
    in {
      packages = each (pkgs: {
        default = pkgs.stdenv.mkDerivation {
          pname = "morula";
          version = "0.1.0";
          src = ../..;
          nativeBuildInputs = [ pkgs.cmake pkgs.ninja ];
          buildInputs = [ pkgs.nlohmann_json pkgs.cli11 pkgs.fmt pkgs.tinygltf ];
          # Programs that link morula::robot link it.
          propagatedBuildInputs = [ pkgs.tinyxml-2 ];
          # No network in a build: the page of `morula view` needs npm.
          cmakeFlags = [
            "-DMORULA_INSTALL=ON"
            "-DMORULA_IO=ON"
            "-DMORULA_GLTF=ON"
            "-DMORULA_GRAINS=ON"
            "-DMORULA_ROBOT=ON"
            "-DMORULA_C=ON"
            "-DMORULA_APPS=ON"
            "-DMORULA_PAGE=OFF"
            "-DMORULA_STUDY=OFF"
            "-DMORULA_PYTHON=OFF"
            "-DMORULA_TESTS=OFF"
            "-DMORULA_BENCH=OFF"
            "-DMORULA_BITS=OFF"
            "-DMORULA_EXAMPLES=OFF"
          ];
          meta = {
            description = "Certified sphere trees for deforming triangle meshes";
            license = pkgs.lib.licenses.asl20;
            mainProgram = "morula";
            platforms = systems;
          };
        };
      });
    };
}
