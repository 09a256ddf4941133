"""What a bag or an output folder of run_scenario holds, read for plot_bag and replay."""
