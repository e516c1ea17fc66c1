trap - EXIT
printf '%s\n' "${ids[@]}" >"$here/jobs"
echo "submitted: ${ids[*]}"
echo "how far:   $status"
echo "logs:      $here/logs"
echo "cancel:    scancel ${ids[*]}"
