# Sourced by setup.bash: completion of the package's programs where somebody types.
if [[ $- == *i* ]]; then
  . "$CATKIN_ENV_HOOK_WORKSPACE/share/bash-completion/completions/frictional_contact_sim"
fi
